#include "numeric/stft.h"

#include <cassert>
#include <cmath>

#include "common/angles.h"

namespace mocaplm {

Eigen::VectorXd hann_window(Eigen::Index n) {
  assert(n >= 1);
  Eigen::VectorXd window(n);
  for (Eigen::Index t = 0; t < n; ++t)
    window[t] = (1 - std::cos(kTurn * static_cast<double>(t) / static_cast<double>(n))) / 2;
  return window;
}

Eigen::MatrixXd stft_basis(Eigen::Index n) {
  const Eigen::VectorXd window = hann_window(n);
  const Eigen::Index bins = stft_bins(n);
  Eigen::MatrixXd basis(2 * bins, n);
  for (Eigen::Index k = 0; k < bins; ++k)
    for (Eigen::Index t = 0; t < n; ++t) {
      // The product modulo n keeps the angle small, so that the sine of half a turn is 0.
      const double angle = kTurn * static_cast<double>(k * t % n) / static_cast<double>(n);
      basis(k, t) = window[t] * std::cos(angle);
      basis(bins + k, t) = -window[t] * std::sin(angle);
    }
  return basis;
}

Eigen::Index stft_frames(Eigen::Index samples, Eigen::Index window, Eigen::Index hop) {
  assert(window >= 1 && hop >= 1);
  return samples < window ? 0 : (samples - window) / hop + 1;
}

}  // namespace mocaplm
