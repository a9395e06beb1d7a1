#include "numeric/lilliefors.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "common/random.h"
#include "numeric/distributions.h"

namespace mocaplm::lilliefors_test {
namespace {

Eigen::VectorXd normals(Random& random, Eigen::Index n) {
  Eigen::VectorXd values(n);
  for (Eigen::Index i = 0; i < n; ++i) values(i) = random.normal();
  return values;
}

// Molin and Abdi 1998, "New tables and numerical approximation for the
// Kolmogorov-Smirnov/Lilliefors/Van Soest test of normality", 100,000 samples each.
TEST(Lilliefors, CriticalValuesAreThePublishedOnes) {
  struct Row {
    Eigen::Index n;
    double a20, a10, a05, a01;
  };
  for (const Row& row :
       {Row{5, .2893, .3188, .3427, .3959}, Row{10, .2171, .2410, .2616, .3037},
        Row{20, .1589, .1764, .1920, .2226}, Row{40, .1147, .1275, .1386, .1616}}) {
    const LillieforsNull null(row.n, 60000, 3);
    EXPECT_NEAR(null.critical(0.20), row.a20, 0.002) << row.n;
    EXPECT_NEAR(null.critical(0.10), row.a10, 0.002) << row.n;
    EXPECT_NEAR(null.critical(0.05), row.a05, 0.003) << row.n;
    EXPECT_NEAR(null.critical(0.01), row.a01, 0.005) << row.n;
    EXPECT_NEAR(null.p_value(row.a05), 0.05, 0.006) << row.n;
  }
}

// The supremum, looked for on both sides of a fine grid of places.
TEST(Lilliefors, StatisticIsTheSupremum) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    Eigen::VectorXd x = normals(random, 12);
    if (round % 2) x = x.array().exp();
    const double mean = x.mean(), deviation = std::sqrt((x.array() - mean).square().sum() / 11);
    double most = 0;
    for (double at = -6; at <= 6; at += 1e-4) {
      const double place = mean + deviation * at;
      const double share = static_cast<double>((x.array() <= place).count()) / 12;
      most = std::max(most, std::abs(share - normal_cdf(at)));
    }
    EXPECT_NEAR(lilliefors_statistic(x), most, 1e-4);
    EXPECT_NEAR(lilliefors_statistic((x.array() * 70 - 3).matrix()), lilliefors_statistic(x),
                1e-12);
  }
  EXPECT_EQ(lilliefors_statistic(Eigen::VectorXd::Constant(9, 2.5)), 0);
}

TEST(Lilliefors, ADesignOfAConstantAloneIsTheClassicalTest) {
  const LillieforsNull plain(15, 20000, 5), constant(Eigen::MatrixXd(15, 0), 20000, 6);
  for (const double alpha : {0.3, 0.1, 0.05})
    EXPECT_NEAR(plain.critical(alpha), constant.critical(alpha), 0.003);
}

// p-values of residuals of normal errors are uniform under the design's own distribution.
TEST(Lilliefors, ResidualsOfNormalErrorsHaveUniformPValues) {
  Random random(7);
  const Eigen::Index n = 24, k = 8;
  Eigen::MatrixXd design(n, k);
  for (Eigen::Index j = 0; j < k; ++j) design.col(j) = normals(random, n);
  Eigen::MatrixXd full(n, k + 1);
  full << design, Eigen::VectorXd::Ones(n);
  const LillieforsNull null(design, 4000, 8);
  int below_10 = 0, below_50 = 0;
  for (int round = 0; round < 2000; ++round) {
    const Eigen::VectorXd y = normals(random, n);
    const Eigen::VectorXd e = y - full * full.householderQr().solve(y);
    const double p = null.p_value(lilliefors_statistic(e));
    below_10 += p <= 0.1;
    below_50 += p <= 0.5;
  }
  EXPECT_NEAR(below_10 / 2000.0, 0.1, 0.03);
  EXPECT_NEAR(below_50 / 2000.0, 0.5, 0.04);
}

TEST(Lilliefors, FindsWhatIsNotNormal) {
  Random random(9);
  const LillieforsNull null(50, 4000, 10);
  int found = 0;
  for (int round = 0; round < 100; ++round)
    found += null.p_value(lilliefors_statistic(normals(random, 50).array().exp())) < 0.05;
  EXPECT_GT(found, 95);
}

TEST(Lilliefors, SameSeedSameValues) {
  EXPECT_EQ(LillieforsNull(10, 500, 1).critical(0.05), LillieforsNull(10, 500, 1).critical(0.05));
}

}  // namespace
}  // namespace mocaplm::lilliefors_test
