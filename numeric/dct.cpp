#include "numeric/dct.h"

#include <cassert>
#include <cmath>

#include "common/angles.h"

namespace mocaplm {

namespace {}  // namespace

Eigen::MatrixXd dct_matrix(Eigen::Index n) {
  assert(n >= 1);
  const auto size = static_cast<double>(n);
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index t = 0; t < n; ++t)
      matrix(k, t) = std::sqrt((k == 0 ? 1 : 2) / size) *
                     std::cos(kPi * (static_cast<double>(t) + 0.5) * static_cast<double>(k) / size);
  return matrix;
}

Eigen::MatrixXd dct_rows(Eigen::Index n, Eigen::Index first, Eigen::Index count) {
  assert(n >= 1 && first >= 0 && count >= 0 && first + count <= n);
  // cos(pi (2t + 1) k / 2n) has the period 4n in (2t + 1) k.
  Eigen::VectorXd cosine(4 * n);
  for (Eigen::Index i = 0; i < 4 * n; ++i)
    cosine[i] = std::cos(kPi * static_cast<double>(i) / static_cast<double>(2 * n));
  Eigen::MatrixXd rows(count, n);
  for (Eigen::Index t = 0; t < n; ++t)
    for (Eigen::Index k = first; k < first + count; ++k)
      rows(k - first, t) =
          std::sqrt((k == 0 ? 1 : 2) / static_cast<double>(n)) * cosine[(2 * t + 1) * k % (4 * n)];
  return rows;
}

Eigen::MatrixXd dct4_matrix(Eigen::Index n) {
  const auto size = static_cast<double>(n);
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index t = 0; t < n; ++t)
      matrix(k, t) = std::sqrt(2 / size) * std::cos(kPi * (static_cast<double>(t) + 0.5) *
                                                    (static_cast<double>(k) + 0.5) / size);
  return matrix;
}

LapFilter::LapFilter(Eigen::Index n) : block_(n) {
  const Eigen::Index half = n / 2;
  if (half == 0) return;
  // J X J is X with rows and columns reversed.
  odd_ = (dct_matrix(half).transpose() * dct4_matrix(half)).reverse();
}

void LapFilter::run(Eigen::Ref<Eigen::MatrixXd> signal, const Eigen::MatrixXd& odd) const {
  assert(signal.rows() % block_ == 0);
  const Eigen::Index half = block_ / 2;
  if (half == 0) return;
  Eigen::MatrixXd even(half, signal.cols()), difference(half, signal.cols());
  for (Eigen::Index border = block_; border < signal.rows(); border += block_) {
    auto before = signal.middleRows(border - half, half);
    auto after = signal.middleRows(border, half);
    even = before + after.colwise().reverse();
    difference = odd * (before.colwise().reverse() - after);
    before = 0.5 * (even + difference.colwise().reverse());
    after = 0.5 * (even.colwise().reverse() - difference);
  }
}

}  // namespace mocaplm
