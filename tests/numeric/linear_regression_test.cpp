#include "numeric/linear_regression.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "common/random.h"
#include "numeric/distributions.h"
#include "support/refusal.h"

namespace mocaplm::linear_regression_test {
namespace {

Eigen::MatrixXd normals(Random& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd values(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < columns; ++j) values(i, j) = random.normal();
  return values;
}

Eigen::MatrixXd with_ones(const Eigen::MatrixXd& x) {
  Eigen::MatrixXd all(x.rows(), x.cols() + 1);
  all << x, Eigen::VectorXd::Ones(x.rows());
  return all;
}

struct Case {
  Eigen::MatrixXd x, y, truth;
};

Case made_up(std::uint64_t seed, Eigen::Index n, Eigen::Index k, Eigen::Index r, double noise) {
  Random random(seed);
  Case made;
  made.x = normals(random, n, k) * 3;
  made.x.col(0).array() += 50;  // far from zero
  made.truth = normals(random, r, k + 1);
  made.y = with_ones(made.x) * made.truth.transpose() + noise * normals(random, n, r);
  return made;
}

// Equation 6 as it is printed: F = P [Q; 1]^+.
TEST(LinearRegression, IsThePseudoInverse) {
  const Case made = made_up(1, 40, 4, 3, 0.5);
  const LinearRegression fit = fit_linear(made.x, made.y);
  const Eigen::MatrixXd a = with_ones(made.x).transpose();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::MatrixXd inverse =
      svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal() * svd.matrixU().transpose();
  EXPECT_LT((fit.f - made.y.transpose() * inverse).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(fit.rank, 5);
  const Eigen::MatrixXd gram = (a * a.transpose()).inverse();
  EXPECT_LT((fit.gram_inverse - gram).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((fit.residuals - (made.y - a.transpose() * fit.f.transpose())).cwiseAbs().maxCoeff(),
            1e-9);
  EXPECT_NEAR(fit.leverage.sum(), 5, 1e-9);
  const Eigen::MatrixXd plain = fit.residuals.transpose() * fit.residuals / 35;
  EXPECT_LT((fit.covariance() - plain).cwiseAbs().maxCoeff(), 1e-12);
}

// A plain and slow minimisation: coordinate descent on equation 5.
TEST(LinearRegression, HasTheLeastSquares) {
  const Case made = made_up(2, 25, 3, 1, 1);
  const Eigen::MatrixXd a = with_ones(made.x.rowwise() - made.x.colwise().mean());
  Eigen::VectorXd f = Eigen::VectorXd::Zero(4);
  for (int round = 0; round < 3000; ++round)
    for (int j = 0; j < 4; ++j)
      f(j) += a.col(j).dot(made.y.col(0) - a * f) / a.col(j).squaredNorm();
  const LinearRegression fit = fit_linear(made.x, made.y);
  EXPECT_LT((fit.f.row(0).head(3).transpose() - f.head(3)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_NEAR((made.y.col(0) - a * f).squaredNorm(), fit.residuals.squaredNorm(), 1e-8);
}

TEST(LinearRegression, ConstantAndRepeatedConditionsDoNoHarm) {
  Case made = made_up(3, 30, 3, 2, 0.1);
  const LinearRegression plain = fit_linear(made.x, made.y);
  Eigen::MatrixXd more(30, 5);
  more << made.x, Eigen::VectorXd::Constant(30, 7.0), 2 * made.x.col(1);
  const LinearRegression fit = fit_linear(more, made.y);
  EXPECT_EQ(fit.rank, 4);
  EXPECT_LT((fit.residuals - plain.residuals).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(fit.f(0, 3), 0);
  EXPECT_NEAR(fit.f(0, 1) + 2 * fit.f(0, 4), plain.f(0, 1), 1e-9);
  const LinearRegression none = fit_linear(Eigen::MatrixXd(30, 0), made.y);
  EXPECT_NEAR(none.f(0, 0), made.y.col(0).mean(), 1e-12);
}

// Ridge against least squares on rows that pull the slopes to zero.
TEST(LinearRegression, RidgeIsLeastSquaresWithMoreRows) {
  const Case made = made_up(4, 20, 2, 1, 1);
  const double ridge = 0.3;
  const Eigen::RowVectorXd mean = made.x.colwise().mean();
  const Eigen::RowVectorXd sd = (made.x.rowwise() - mean).array().square().colwise().mean().sqrt();
  Eigen::MatrixXd a(22, 3);
  a << with_ones(made.x), std::sqrt(ridge * 20) * sd(0), 0, 0, 0, std::sqrt(ridge * 20) * sd(1), 0;
  Eigen::VectorXd b(22);
  b << made.y, 0, 0;
  const Eigen::VectorXd f = (a.transpose() * a).ldlt().solve(a.transpose() * b);
  RegressionOptions options;
  options.ridge = ridge;
  EXPECT_LT((fit_linear(made.x, made.y, options).f.transpose() - f).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(LinearRegression, OutliersDoNotMoveARobustFit) {
  Case made = made_up(5, 60, 3, 2, 0.2);
  Random random(6);
  for (Eigen::Index i = 0; i < 12; ++i) made.y.row(5 * i).array() += 40;
  made.x.row(10).array() += 100;  // and far outside
  RegressionOptions options;
  options.robust = true;
  const LinearRegression plain = fit_linear(made.x, made.y);
  const LinearRegression fit = fit_linear(made.x, made.y, options);
  const auto slopes_off = [&](const LinearRegression& one) {
    return (one.f - made.truth).leftCols(3).cwiseAbs().maxCoeff();
  };
  EXPECT_GT(slopes_off(plain), 0.5);
  EXPECT_LT(slopes_off(fit), 0.05);
  for (Eigen::Index i = 0; i < 12; ++i) EXPECT_EQ(fit.weights(5 * i, 0), 0) << i;
  EXPECT_NEAR(std::sqrt(fit.covariance()(0, 0)), 0.2, 0.06);
}

// Without outliers it is nearly as exact as least squares: 95% efficient in theory.
TEST(LinearRegression, ARobustFitCostsLittleWithoutOutliers) {
  RegressionOptions options;
  options.robust = true;
  double plain = 0, robust = 0;
  for (std::uint64_t seed = 10; seed < 50; ++seed) {
    const Case made = made_up(seed, 50, 2, 1, 1);
    plain += (fit_linear(made.x, made.y).f - made.truth).leftCols(2).squaredNorm();
    robust += (fit_linear(made.x, made.y, options).f - made.truth).leftCols(2).squaredNorm();
  }
  EXPECT_LT(robust / plain, 1.25);
}

TEST(LinearRegression, AnExactFitOfMostRowsIsFoundRobustly) {
  Case made = made_up(7, 20, 2, 1, 0);
  made.y(3, 0) += 5;
  RegressionOptions options;
  options.robust = true;
  const LinearRegression fit = fit_linear(made.x, made.y, options);
  EXPECT_LT((fit.f - made.truth).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(fit.weights(3, 0), 0);
}

// Each statistic against fits that really leave a row out.
TEST(LinearRegression, LeavingOneOutIsWhatItSays) {
  const Case made = made_up(8, 18, 3, 2, 1);
  const LinearRegression fit = fit_linear(made.x, made.y);
  Eigen::MatrixXd one_out_f(18, 4), predictions(18, 2);
  for (Eigen::Index i = 0; i < 18; ++i) {
    Eigen::MatrixXd x(17, 3), y(17, 2);
    x << made.x.topRows(i), made.x.bottomRows(17 - i);
    y << made.y.topRows(i), made.y.bottomRows(17 - i);
    const LinearRegression one = fit_linear(x, y);
    one_out_f.row(i) = one.f.row(1);
    predictions.row(i) = with_ones(made.x.row(i)) * one.f.transpose();
  }
  EXPECT_LT((left_out_predictions(fit, made.x, made.y, {}) - predictions).cwiseAbs().maxCoeff(),
            1e-9);
  const ResponseStatistics found = response_statistics(fit, made.x, made.y, 1);
  const Eigen::VectorXd variance =
      (one_out_f.rowwise() - one_out_f.colwise().mean()).colwise().squaredNorm() * 17.0 / 18.0;
  EXPECT_LT(((found.jackknife_variance - variance).array() / variance.array()).abs().maxCoeff(),
            1e-7);
  const double mean = made.y.col(1).mean();
  EXPECT_NEAR(found.left_out_r_squared,
              1 - (made.y.col(1) - predictions.col(1)).squaredNorm() /
                      (made.y.col(1).array() - mean).square().sum(),
              1e-9);
}

TEST(LinearRegression, FTestHoldsItsLevelAndIntervalsTheirCoverage) {
  Random random(11);
  int rejected = 0, covered = 0;
  const int rounds = 2000;
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXd x = normals(random, 20, 3), y = normals(random, 20, 1);
    const LinearRegression fit = fit_linear(x, y);
    const ResponseStatistics found = response_statistics(fit, x, y, 0);
    rejected += found.f_p < 0.05;
    covered += std::abs(fit.f(0, 1)) <= found.half_width(1);
  }
  EXPECT_NEAR(rejected / double(rounds), 0.05, 0.015);
  EXPECT_NEAR(covered / double(rounds), 0.95, 0.015);
}

// One condition: F is t^2 of its slope, by the textbook's formulas.
TEST(LinearRegression, OneConditionAgreesWithTheTextbook) {
  Eigen::MatrixXd x(5, 1), y(5, 1);
  x << 1, 2, 3, 4, 5;
  y << 2.1, 3.9, 6.2, 7.8, 10.1;  // slope 1.99, constant 0.05, squared residuals 0.107
  const LinearRegression fit = fit_linear(x, y);
  EXPECT_NEAR(fit.f(0, 0), 1.99, 1e-12);
  EXPECT_NEAR(fit.f(0, 1), 0.05, 1e-12);
  const ResponseStatistics found = response_statistics(fit, x, y, 0);
  const double variance = 0.107 / 3;
  EXPECT_NEAR(found.f, 1.99 * 1.99 * 10 / variance, 1e-6);
  EXPECT_NEAR(found.half_width(0), 3.182446 * std::sqrt(variance / 10), 1e-6);
  EXPECT_NEAR(found.r_squared, 1 - 0.107 / (0.107 + 39.601), 1e-9);
  EXPECT_NEAR(found.f_p, t_tails(std::sqrt(found.f), 3), 1e-12);
}

TEST(LinearRegression, ExactAndConstantResponsesAreNoTrouble) {
  Case made = made_up(12, 12, 2, 2, 0);
  made.y.col(1).setConstant(4);
  const LinearRegression fit = fit_linear(made.x, made.y);
  const ResponseStatistics exact = response_statistics(fit, made.x, made.y, 0);
  EXPECT_TRUE(std::isinf(exact.f));
  EXPECT_EQ(exact.f_p, 0);
  const ResponseStatistics constant = response_statistics(fit, made.x, made.y, 1);
  EXPECT_EQ(constant.f, 0);
  EXPECT_EQ(constant.f_p, 1);
}

TEST(LinearRegression, RefusesTooFewRowsAndNumbersThatAreNone) {
  const Case made = made_up(13, 4, 3, 1, 1);
  EXPECT_PRED2(contains, refusal([&] { fit_linear(made.x, made.y); }), "4 rows for 4 unknowns");
  Eigen::MatrixXd bad = made_up(13, 9, 1, 1, 1).x;
  const Eigen::MatrixXd y = bad;
  bad(2, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_PRED2(contains, refusal([&] { fit_linear(bad, y); }), "finite");
  EXPECT_PRED2(contains, refusal([&] { fit_linear(y, bad); }), "finite");
}

}  // namespace
}  // namespace mocaplm::linear_regression_test
