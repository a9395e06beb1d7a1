#include "emulator/var.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "common/angles.h"
#include "common/error.h"

namespace mocaplm::var_test {

namespace {

// x(t) = c + A x(t - 1) + B x(t - 2) + e(t)
std::vector<Eigen::MatrixXd> simulated(int count, Eigen::Index frames) {
  Random random(1);
  Eigen::Matrix2d a, b, s;
  a << 0.5, 0.2, -0.1, 0.4;
  b << 0.2, 0, 0.1, -0.3;
  s << 0.5, 0, 0.2, 0.3;
  std::vector<Eigen::MatrixXd> courses;
  for (int k = 0; k < count; ++k) {
    Eigen::MatrixXd course(2, frames);
    for (Eigen::Index t = 0; t < frames; ++t) {
      const Eigen::Vector2d e(random.normal(), random.normal());
      Eigen::Vector2d now = Eigen::Vector2d(1, -2) + s * e;
      if (t > 0) now += a * course.col(t - 1);
      if (t > 1) now += b * course.col(t - 2);
      course(0, t) = now[0];
      course(1, t) = now[1];
    }
    courses.push_back(course);
  }
  return courses;
}

TEST(Var, RecoversWhatMadeTheData) {
  const VectorAutoregression var = fit_var(simulated(40, 400), 2);
  Eigen::MatrixXd expected(2, 5);
  expected << 1, 0.5, 0.2, 0.2, 0, -2, -0.1, 0.4, 0.1, -0.3;
  EXPECT_LT((var.weights - expected).cwiseAbs().maxCoeff(), 0.06);
  Eigen::Matrix2d s;
  s << 0.5, 0, 0.2, 0.3;
  EXPECT_LT((var.factor - s).cwiseAbs().maxCoeff(), 0.02);
}

TEST(Var, IsLeastSquares) {
  const auto courses = simulated(3, 30);
  const VectorAutoregression var = fit_var(courses, 3);
  Eigen::MatrixXd past(3 * 27, 7), now(3 * 27, 2);
  for (int k = 0; k < 3; ++k)
    for (int t = 3; t < 30; ++t) {
      const auto& course = courses[static_cast<std::size_t>(k)];
      const int row = 27 * k + t - 3;
      past(row, 0) = 1;
      for (int p = 1; p <= 3; ++p) past.block(row, 2 * p - 1, 1, 2) = course.col(t - p).transpose();
      now.row(row) = course.col(t).transpose();
    }
  const Eigen::MatrixXd weights = past.colPivHouseholderQr().solve(now).transpose();
  EXPECT_LT((var.weights - weights).norm(), 1e-4);
  const Eigen::MatrixXd rest = now - past * weights.transpose();
  const Eigen::MatrixXd s = rest.transpose() * rest / (3 * 27.0);
  EXPECT_LT((var.factor * var.factor.transpose() - s).norm(), 1e-4);
  double sum = 0;
  for (int t = 3; t < 30; ++t) {
    const Eigen::VectorXd e = rest.row(27 + t - 3).transpose();
    sum += -std::log(2 * kPi) - 0.5 * std::log(s.determinant()) - 0.5 * e.dot(s.inverse() * e);
  }
  EXPECT_NEAR(var.log_likelihood(courses[1]), sum, 0.05);
}

TEST(Var, SamplesAreLikeTheData) {
  const auto courses = simulated(40, 200);
  const VectorAutoregression var = fit_var(courses, 2);
  Random random(3);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero(), of_data = Eigen::Vector2d::Zero();
  double square = 0, square_of_data = 0;
  for (int k = 0; k < 40; ++k) {
    const Eigen::MatrixXd drawn = var.sample(200, random);
    const auto& course = courses[static_cast<std::size_t>(k)];
    mean += drawn.rightCols(150).rowwise().mean() / 40;
    of_data += course.rightCols(150).rowwise().mean() / 40;
    square += drawn.rightCols(150).squaredNorm() / 40;
    square_of_data += course.rightCols(150).squaredNorm() / 40;
  }
  EXPECT_LT((mean - of_data).norm(), 0.1);
  EXPECT_NEAR(square / square_of_data, 1, 0.05);
}

TEST(Var, UnstableFitsStayFinite) {
  std::vector<Eigen::MatrixXd> courses;
  for (int k = 0; k < 5; ++k) {
    Eigen::MatrixXd course(1, 20);
    for (int t = 0; t < 20; ++t) course(0, t) = std::pow(2.0 + 0.1 * k, t);
    courses.push_back(course);
  }
  Random random(1);
  EXPECT_TRUE(fit_var(courses, 1).sample(5000, random).allFinite());
}

TEST(Var, FilesAndBadInput) {
  const auto courses = simulated(4, 30);
  const VectorAutoregression var = fit_var(courses, 2);
  const VectorAutoregression again = read_var(parse_json(var_json(var).dump(), "x"), "x");
  EXPECT_EQ(again.weights, var.weights);
  Random a(5), b(5);
  EXPECT_EQ(var.sample(40, a), again.sample(40, b));
  EXPECT_THROW(fit_var(courses, 30), UsageError);
  Json broken = var_json(var);
  broken["starts"] = Json::array();
  EXPECT_THROW(read_var(broken, "x"), DataError);
}

}  // namespace

}  // namespace mocaplm::var_test
