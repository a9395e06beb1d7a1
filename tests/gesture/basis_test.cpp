#include "gesture/basis.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <complex>

#include "common/angles.h"
#include "common/random.h"

namespace mocaplm::basis_test {
namespace {

// A smooth movement that the basis does not hold.
Eigen::MatrixXd movement(Eigen::Index samples) {
  Eigen::MatrixXd values(samples, 2);
  for (Eigen::Index j = 0; j < samples; ++j) {
    const double tau = static_cast<double>(j) / static_cast<double>(samples - 1);
    values(j, 0) = std::exp(tau) + tau * tau * tau;
    values(j, 1) = 3 - std::cos(2.3 * tau);
  }
  return values;
}

TEST(Basis, IsEquationTwo) {
  const Basis basis(3);
  ASSERT_EQ(basis.size(), 5);
  const Eigen::VectorXd phi = basis.at(0.3);
  EXPECT_EQ(phi(0), 1);
  EXPECT_EQ(phi(1), 0.3);
  for (int k = 1; k <= 3; ++k) EXPECT_NEAR(phi(k + 1), std::sin(k * kPi * 0.3), 1e-15);
  const Eigen::MatrixXd table = basis.table(11);
  EXPECT_LT((table.row(3).transpose() - phi).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(table(10, 4), 0) << "exactly zero at the end";
}

TEST(Basis, DerivativesAreFiniteDifferences) {
  const Basis basis(6);
  const double h = 1e-5;
  for (const double tau : {0.0, 0.21, 0.5, 1.0}) {
    const Eigen::VectorXd up = basis.at(tau + h), down = basis.at(tau - h);
    EXPECT_LT((basis.derivative(tau) - (up - down) / (2 * h)).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((basis.second(tau) - (up - 2 * basis.at(tau) + down) / (h * h)).cwiseAbs().maxCoeff(),
              1e-3);
  }
}

// Equation 4 as it reads: the odd extension over a period of 2 and its Fourier transform, a plain
// sum. Only sines are in it, and their coefficients are P.
TEST(Expansion, IsTheFourierTransformOfTheOddExtension) {
  const Eigen::Index samples = 33, period = 64;
  const Eigen::MatrixXd values = movement(samples);
  const Expansion expansion(9, samples);
  const Eigen::MatrixXd p = expansion.coefficients(values);
  for (Eigen::Index v = 0; v < 2; ++v) {
    EXPECT_EQ(p(0, v), values(0, v));
    EXPECT_EQ(p(1, v), values(samples - 1, v) - values(0, v));
    const auto d = [&](Eigen::Index j) {
      return values(j, v) - (p(0, v) + p(1, v) * static_cast<double>(j) / 32);
    };
    for (int k = 0; k <= 9; ++k) {
      std::complex<double> sum = 0;
      for (Eigen::Index j = 0; j < period; ++j) {
        const double odd = j <= 32 ? d(j) : -d(period - j);
        sum += odd * std::polar(1.0, -2 * kPi * k * static_cast<double>(j) / 64);
      }
      EXPECT_NEAR(sum.real(), 0, 1e-12) << "no cosines";
      if (k > 0) {
        EXPECT_NEAR(-2 * sum.imag() / 64, p(k + 1, v), 1e-12) << k;
      }
    }
  }
}

TEST(Expansion, IsTheLeastSquaresFitOfTheSines) {
  const Eigen::Index samples = 60;
  const Eigen::MatrixXd values = movement(samples);
  const Expansion expansion(7, samples);
  const Eigen::MatrixXd p = expansion.coefficients(values);
  const Eigen::MatrixXd table = expansion.basis().table(samples);
  const Eigen::MatrixXd rest = values - table.leftCols(2) * p.topRows(2);
  const Eigen::MatrixXd fitted = table.rightCols(7).colPivHouseholderQr().solve(rest);
  EXPECT_LT((fitted - p.bottomRows(7)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Expansion, FindsTheCoefficientsThatMadeAMovement) {
  Random random(1);
  const Expansion expansion(12, 200);
  Eigen::MatrixXd p(14, 3);
  for (Eigen::Index i = 0; i < p.size(); ++i) p(i) = random.normal();
  EXPECT_LT((expansion.coefficients(expansion.values(p)) - p).cwiseAbs().maxCoeff(), 1e-12);
}

// Figure 1: the slopes at both ends are free, so the error falls with N^-3 or faster.
TEST(Expansion, MoreSinesComeNearer) {
  const Eigen::MatrixXd values = movement(200);
  double before = 1;
  for (const int n : {2, 5, 10, 20}) {
    const Expansion expansion(n, 200);
    const double error =
        (expansion.values(expansion.coefficients(values)) - values).cwiseAbs().maxCoeff();
    EXPECT_LT(error, before / 3) << n;
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(Resample, IsExactForParabolasAtUnevenTimes) {
  Eigen::VectorXd time(6);
  time << 2, 2.1, 2.5, 2.6, 3.3, 4;
  Eigen::MatrixXd values(6, 2);
  values.col(0) = 3 - 2 * time.array() + 0.5 * time.array().square();
  values.col(1) = 7 * time.array();
  const Eigen::MatrixXd out = resample(time, values, 41);
  for (Eigen::Index j = 0; j < 41; ++j) {
    const double t = 2 + static_cast<double>(j) * 0.05;
    EXPECT_NEAR(out(j, 0), 3 - 2 * t + 0.5 * t * t, 1e-12);
    EXPECT_NEAR(out(j, 1), 7 * t, 1e-12);
  }
}

TEST(Resample, KeepsSamplesAndEnds) {
  const Eigen::MatrixXd values = movement(11);
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(11, 0, 0.7);
  EXPECT_LT((resample(time, values, 11) - values).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::MatrixXd fine = resample(time, values, 101);
  for (Eigen::Index j = 0; j < 11; ++j) EXPECT_LT((fine.row(10 * j) - values.row(j)).norm(), 1e-9);
  const Eigen::MatrixXd two = resample(time.head(2), values.topRows(2), 3);
  EXPECT_LT((two.row(1) - (values.row(0) + values.row(1)) / 2).norm(), 1e-12);
}

}  // namespace
}  // namespace mocaplm::basis_test
