#include "numeric/lda.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm::lda_test {
namespace {

struct Samples {
  Eigen::MatrixXd x;
  std::vector<int> classes;
};

Samples gaussians(std::uint64_t seed, int n, int d, int n_classes, double apart,
                  double far_away = 0) {
  Random random(seed);
  const auto noise = [&](Eigen::Index rows, Eigen::Index cols) {
    Eigen::MatrixXd m(rows, cols);
    for (Eigen::Index i = 0; i < rows; ++i)
      for (Eigen::Index j = 0; j < cols; ++j) m(i, j) = random.normal();
    return m;
  };
  const Eigen::MatrixXd means = apart * noise(n_classes, d), mixing = noise(d, d);
  Samples samples{noise(n, d) * mixing, {}};
  for (int i = 0; i < n; ++i) {
    samples.classes.push_back(
        static_cast<int>(random.below(static_cast<std::uint64_t>(n_classes))));
    samples.x.row(i) += means.row(samples.classes.back());
  }
  samples.x.array() += far_away;
  return samples;
}

// The formula as it is written, with an explicit inverse and no centring.
Eigen::MatrixXd slow_scores(const Samples& s, int n_classes, double shrinkage,
                            const Eigen::MatrixXd& x) {
  const auto n = static_cast<double>(s.x.rows()), d = static_cast<double>(s.x.cols());
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(n_classes, s.x.cols()),
                  scatter = Eigen::MatrixXd::Zero(s.x.cols(), s.x.cols());
  std::vector<double> counts(static_cast<std::size_t>(n_classes));
  for (Eigen::Index i = 0; i < s.x.rows(); ++i) {
    means.row(s.classes[static_cast<std::size_t>(i)]) += s.x.row(i);
    counts[static_cast<std::size_t>(s.classes[static_cast<std::size_t>(i)])] += 1;
  }
  for (int k = 0; k < n_classes; ++k) means.row(k) /= counts[static_cast<std::size_t>(k)];
  for (Eigen::Index i = 0; i < s.x.rows(); ++i) {
    const Eigen::VectorXd off =
        (s.x.row(i) - means.row(s.classes[static_cast<std::size_t>(i)])).transpose();
    scatter += off * off.transpose() / n;
  }
  const Eigen::MatrixXd covariance =
      (1 - shrinkage) * scatter +
      shrinkage * scatter.trace() / d * Eigen::MatrixXd::Identity(s.x.cols(), s.x.cols());
  const Eigen::MatrixXd inverse = covariance.inverse();
  Eigen::MatrixXd scores(x.rows(), n_classes);
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (int k = 0; k < n_classes; ++k) {
      const Eigen::VectorXd m = means.row(k).transpose();
      scores(i, k) = x.row(i) * inverse * m - 0.5 * m.dot(inverse * m) +
                     std::log(counts[static_cast<std::size_t>(k)] / n);
    }
  return scores;
}

// Differences within a row: scores mean something up to a constant only.
Eigen::MatrixXd relative(const Eigen::MatrixXd& scores) {
  return scores.colwise() - scores.col(0);
}

TEST(Lda, TwoGaussiansGiveTheClosedForm) {
  // Classes {-3, -1} and {1, 3, 1, 3}: means -2 and 2, variance 1, priors 1/3 and 2/3.
  Eigen::MatrixXd x(6, 1);
  x << -3, -1, 1, 3, 1, 3;
  const Lda lda = Lda::fit(x, {0, 0, 1, 1, 1, 1}, 2, 0);
  for (const double at : {-5.0, -0.3, 0.0, 4.0}) {
    const Eigen::MatrixXd scores = lda.scores(Eigen::MatrixXd::Constant(1, 1, at));
    EXPECT_NEAR(scores(0, 1) - scores(0, 0), 4 * at + std::log(2), 1e-12);
  }
  // The border lies where 4 x + log 2 = 0.
  EXPECT_EQ(lda.predict(Eigen::MatrixXd::Constant(1, 1, -0.174)), std::vector<int>{0});
  EXPECT_EQ(lda.predict(Eigen::MatrixXd::Constant(1, 1, -0.173)), std::vector<int>{1});
}

TEST(Lda, AgreesWithTheFormulaWrittenOut) {
  for (const double shrinkage : {0.0, 0.1, 0.7, 1.0}) {
    const Samples train = gaussians(1, 200, 7, 4, 1), test = gaussians(2, 50, 7, 4, 1);
    const Lda lda = Lda::fit(train.x, train.classes, 4, shrinkage);
    EXPECT_EQ(lda.dimensions(), 7);
    EXPECT_EQ(lda.n_classes(), 4);
    const Eigen::MatrixXd difference =
        relative(lda.scores(test.x)) - relative(slow_scores(train, 4, shrinkage, test.x));
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-8) << shrinkage;
  }
}

TEST(Lda, AgreesWithMoreDimensionsThanSamples) {
  const Samples train = gaussians(3, 30, 80, 3, 2), test = gaussians(4, 20, 80, 3, 2);
  const Lda lda = Lda::fit(train.x, train.classes, 3, 0.2);
  const Eigen::MatrixXd difference =
      relative(lda.scores(test.x)) - relative(slow_scores(train, 3, 0.2, test.x));
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_TRUE(Lda::fit(train.x, train.classes, 3, 0).scores(test.x).allFinite());
}

TEST(Lda, DataFarFromTheOriginLosesNothing) {
  const Samples near = gaussians(5, 300, 5, 3, 2), far = gaussians(5, 300, 5, 3, 2, 1e6);
  const Lda at_near = Lda::fit(near.x, near.classes, 3, 0.1),
            at_far = Lda::fit(far.x, far.classes, 3, 0.1);
  EXPECT_LT((at_near.scores(near.x) - at_far.scores(far.x)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Lda, AColumnThatNeverMovesChangesNothing) {
  Samples samples = gaussians(6, 200, 4, 3, 2);
  const Eigen::MatrixXd before = Lda::fit(samples.x, samples.classes, 3, 0).scores(samples.x);
  samples.x.conservativeResize(Eigen::NoChange, 5);
  samples.x.col(4).setConstant(3);
  EXPECT_LT(
      (Lda::fit(samples.x, samples.classes, 3, 0).scores(samples.x) - before).cwiseAbs().maxCoeff(),
      1e-8);
}

TEST(Lda, AClassWithoutSamplesIsNeverPredicted) {
  const Samples samples = gaussians(7, 100, 3, 2, 1);
  const Lda lda = Lda::fit(samples.x, samples.classes, 4, 0.1);
  for (const int k : lda.predict(100 * samples.x)) EXPECT_LT(k, 2);
}

TEST(Lda, RefusesWhatItCannotLearnFrom) {
  Eigen::MatrixXd x = Eigen::MatrixXd::Random(4, 2);
  EXPECT_THROW(Lda::fit(x, {0, 0, 1, 1}, 2, -0.1), UsageError);
  EXPECT_THROW(Lda::fit(x, {0, 0, 1, 1}, 2, std::nan("")), UsageError);
  EXPECT_THROW(Lda::fit(Eigen::MatrixXd(0, 2), {}, 2, 0.1), DataError);
  EXPECT_THROW(Lda::fit(Eigen::MatrixXd::Ones(4, 2), {0, 0, 1, 1}, 2, 0.1), DataError);
  x(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Lda::fit(x, {0, 0, 1, 1}, 2, 0.1), DataError);
}

}  // namespace
}  // namespace mocaplm::lda_test
