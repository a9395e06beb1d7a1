// The short-time Fourier transform (thesis equations 3.1 and 3.2) as a product with a matrix:
// windows are short here (16 frames), so a product is as quick as a fast transform.
#pragma once

#include <Eigen/Core>

namespace mocaplm {

// Hann's window of n samples as in equation 3.2, periodic: (1 - cos(2 pi t / n)) / 2. n >= 1.
Eigen::VectorXd hann_window(Eigen::Index n);

// Frequencies that n real samples tell apart: n / 2 + 1, from 0 to half the rate.
inline Eigen::Index stft_bins(Eigen::Index n) {
  return n / 2 + 1;
}

// (2 * bins, n): rows w[t] cos(2 pi k t / n), then -w[t] sin(2 pi k t / n), the real and the
// imaginary parts of the transform of n samples under Hann's window.
Eigen::MatrixXd stft_basis(Eigen::Index n);

// Frames that lie wholly inside `samples`: at 0, hop, 2 hop, ... None when samples < window.
Eigen::Index stft_frames(Eigen::Index samples, Eigen::Index window, Eigen::Index hop);

// signal (time, channels) to magnitudes (frames * bins, channels), row frame * bins + k. `basis` is
// stft_basis(window); double or float.
template <class Scalar>
Eigen::Matrix<Scalar, -1, -1> stft_magnitudes(
    const Eigen::Ref<const Eigen::Matrix<Scalar, -1, -1, Eigen::RowMajor>>& signal,
    const Eigen::Matrix<Scalar, -1, -1>& basis, Eigen::Index hop) {
  const Eigen::Index bins = basis.rows() / 2, window = basis.cols();
  const Eigen::Index frames = stft_frames(signal.rows(), window, hop);
  Eigen::Matrix<Scalar, -1, -1> magnitudes(frames * bins, signal.cols());
  Eigen::Matrix<Scalar, -1, -1> parts(2 * bins, signal.cols());
  for (Eigen::Index f = 0; f < frames; ++f) {
    parts.noalias() = basis * signal.middleRows(f * hop, window);
    magnitudes.middleRows(f * bins, bins) =
        (parts.topRows(bins).array().square() + parts.bottomRows(bins).array().square()).sqrt();
  }
  return magnitudes;
}

}  // namespace mocaplm
