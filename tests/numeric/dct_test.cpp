#include "numeric/dct.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "common/random.h"

namespace mocaplm::dct_test {
namespace {

Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index cols, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd x(rows, cols);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.normal();
  return x;
}

TEST(Dct, IsTheSumOfCosines) {
  for (const Eigen::Index n : {1, 2, 15, 30, 60}) {
    const Eigen::VectorXd x = noise(n, 1, 1);
    const Eigen::VectorXd y = dct_matrix(n) * x;
    for (Eigen::Index k = 0; k < n; ++k) {
      double sum = 0;
      for (Eigen::Index t = 0; t < n; ++t)
        sum += x[t] * std::cos(kPi / double(n) * (double(t) + 0.5) * double(k));
      EXPECT_NEAR(y[k], sum * std::sqrt((k == 0 ? 1.0 : 2.0) / double(n)), 1e-12);
    }
  }
}

// scipy.fft.dct([1, 2, 3, 4], norm="ortho"), by hand: 5, -2.2304, 0, -0.1585.
TEST(Dct, KnownValues) {
  const Eigen::Vector4d y = dct_matrix(4) * Eigen::Vector4d(1, 2, 3, 4);
  EXPECT_NEAR(y[0], 5, 1e-12);
  EXPECT_NEAR(y[1], -2.230442497, 1e-8);
  EXPECT_NEAR(y[2], 0, 1e-12);
  EXPECT_NEAR(y[3], -0.158512668, 1e-8);
}

TEST(Dct, IsOrthonormal) {
  for (const Eigen::Index n : {1, 2, 7, 64}) {
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
    EXPECT_LT((dct_matrix(n) * dct_matrix(n).transpose() - identity).norm(), 1e-11);
    EXPECT_LT((dct4_matrix(n) * dct4_matrix(n) - identity).norm(), 1e-11) << "its own inverse";
  }
}

TEST(LapFilter, ReconstructsAndKeepsLengths) {
  for (const Eigen::Index n : {1, 2, 15, 30, 60})
    for (const Eigen::Index blocks : {1, 2, 5}) {
      const LapFilter filter(n);
      const Eigen::MatrixXd x = noise(n * blocks, 3, 2);
      Eigen::MatrixXd y = x;
      filter.apply(y);
      EXPECT_NEAR(y.norm(), x.norm(), 1e-10);
      if (blocks == 1) {
        EXPECT_EQ((y - x).norm(), 0) << "there is no border";
      } else if (n > 2) {
        EXPECT_GT((y - x).norm(), 0.1);
      }
      filter.undo(y);
      EXPECT_LT((y - x).norm(), 1e-11);
    }
}

TEST(LapFilter, LeavesAConstantAndTheEndsAlone) {
  Eigen::MatrixXd constant = Eigen::MatrixXd::Constant(90, 2, 3.5);
  LapFilter(30).apply(constant);
  EXPECT_LT((constant.array() - 3.5).abs().maxCoeff(), 1e-12);
  const Eigen::MatrixXd x = noise(90, 1, 3);
  Eigen::MatrixXd y = x;
  LapFilter(30).apply(y);
  EXPECT_EQ((y - x).topRows(15).norm(), 0);
  EXPECT_EQ((y - x).bottomRows(15).norm(), 0);
}

// The variances of the coefficients of a first-order Markov process, from the filter's own matrix:
// fewer coefficients than the plain DCT's hold the same share (Malvar: 9.20 dB against 8.83 dB of
// coding gain for blocks of 8 at a correlation of 0.95).
TEST(LapFilter, HasThePublishedCodingGain) {
  const Eigen::Index n = 8, size = 3 * n;
  Eigen::MatrixXd correlation(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j < size; ++j)
      correlation(i, j) = std::pow(0.95, std::abs(double(i - j)));
  double gain[2];
  for (const bool lapped : {false, true}) {
    Eigen::MatrixXd transform = Eigen::MatrixXd::Identity(size, size);
    if (lapped) LapFilter(n).apply(transform);
    const Eigen::MatrixXd block = dct_matrix(n) * transform.middleRows(n, n);
    const Eigen::ArrayXd variance = (block * correlation * block.transpose()).diagonal();
    gain[lapped] = 10 * std::log10(variance.mean() / std::exp(variance.log().mean()));
  }
  EXPECT_NEAR(gain[0], 8.83, 0.01);
  EXPECT_NEAR(gain[1], 9.20, 0.05);
}

TEST(Dct, RowsAreTheMatrixs) {
  for (const Eigen::Index n : {1, 2, 7, 60}) {
    const Eigen::MatrixXd all = dct_matrix(n);
    EXPECT_LT((dct_rows(n, 0, n) - all).norm(), 1e-12);
    EXPECT_LT((dct_rows(n, n / 2, n - n / 2) - all.bottomRows(n - n / 2)).norm(), 1e-12);
    EXPECT_EQ(dct_rows(n, n, 0).rows(), 0);
  }
}

}  // namespace
}  // namespace mocaplm::dct_test
