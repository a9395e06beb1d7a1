#include "numeric/energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/error.h"
#include "common/random.h"
#include "support/refusal.h"

namespace mocaplm::energy_tests {
namespace {

Eigen::MatrixXd points(Eigen::Index count, Eigen::Index dimensions, Random& random,
                       double scale = 1, double shift = 0) {
  Eigen::MatrixXd x(count, dimensions);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = shift + scale * random.normal();
  return x;
}

Eigen::MatrixXd distances(const Eigen::MatrixXd& x) {
  Eigen::MatrixXd d(x.rows(), x.rows());
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (Eigen::Index j = 0; j < x.rows(); ++j) d(i, j) = (x.row(i) - x.row(j)).norm();
  return d;
}

Eigen::MatrixXd stacked(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd x(a.rows() + b.rows(), a.cols());
  x << a, b;
  return x;
}

// The definition, by plain loops over all ordered pairs.
double mean_distance(const Eigen::MatrixXd& d, const std::vector<int>& groups, int a, int b,
                     double alpha) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < groups.size(); ++i)
    for (std::size_t j = 0; j < groups.size(); ++j)
      if ((a < 0 || groups[i] == a) && (b < 0 || groups[j] == b)) {
        sum += std::pow(d(Eigen::Index(i), Eigen::Index(j)), alpha);
        count += 1;
      }
  return sum / count;
}

TEST(EnergyTest, StatisticIsTheDefinition) {
  Random random(1);
  const Eigen::MatrixXd d = distances(points(17, 3, random));
  std::vector<int> groups(17, 1);
  std::fill_n(groups.begin(), 6, 0);
  for (const double alpha : {0.5, 1.0, 1.7, 2.0}) {
    EnergyOptions options;
    options.alpha = alpha;
    const double expected = 2 * mean_distance(d, groups, 0, 1, alpha) -
                            mean_distance(d, groups, 0, 0, alpha) -
                            mean_distance(d, groups, 1, 1, alpha);
    EXPECT_NEAR(energy_test(d, 6, options).statistic, expected, 1e-12) << alpha;
  }
}

TEST(EnergyTest, RatioOfThreeSamplesIsTheDefinition) {
  Random random(2);
  const Eigen::MatrixXd d = distances(points(15, 2, random));
  const std::vector<int> groups = {0, 2, 1, 1, 0, 2, 2, 0, 1, 1, 2, 2, 1, 0, 2};
  EnergyOptions options;
  options.alpha = 1.3;
  const double n = 15, total = n / 2 * mean_distance(d, groups, -1, -1, 1.3);
  double within = 0;
  for (const int k : {0, 1, 2})
    within += double(std::count(groups.begin(), groups.end(), k)) / 2 *
              mean_distance(d, groups, k, k, 1.3);
  const EnergyTest test = disco_test(d, groups, options);
  EXPECT_NEAR(test.within, within, 1e-12);
  EXPECT_NEAR(test.statistic, total - within, 1e-12);
  EXPECT_NEAR(test.ratio, (total - within) / 2 / (within / (n - 3)), 1e-12);
}

// With alpha 2 the between part is the one of the ordinary analysis of variance.
TEST(EnergyTest, SquaresAreTheAnalysisOfVariance) {
  Random random(3);
  const Eigen::MatrixXd a = points(8, 1, random), b = points(5, 1, random, 1, 2);
  EnergyOptions options;
  options.alpha = 2;
  const EnergyTest test = energy_test(distances(stacked(a, b)), 8, options);
  const double difference = a.mean() - b.mean();
  EXPECT_NEAR(test.statistic, 2 * difference * difference, 1e-10);
  const double squares =
      (a.array() - a.mean()).square().sum() + (b.array() - b.mean()).square().sum();
  EXPECT_NEAR(test.within, squares, 1e-10);
}

// All 20 divisions of 3 + 3 members, by hand, give the p-value that permutations estimate.
TEST(EnergyTest, PermutationsComeNearAllDivisions) {
  Random random(4);
  const Eigen::MatrixXd d = distances(stacked(points(3, 2, random), points(3, 2, random, 1, 1)));
  const double observed = energy_test(d, 3).statistic;
  std::vector<int> groups = {0, 0, 0, 1, 1, 1};
  int extreme = 0, all = 0;
  do {
    const double e = 2 * mean_distance(d, groups, 0, 1, 1) - mean_distance(d, groups, 0, 0, 1) -
                     mean_distance(d, groups, 1, 1, 1);
    extreme += e >= observed - 1e-9;
    ++all;
  } while (std::next_permutation(groups.begin(), groups.end()));
  ASSERT_EQ(all, 20);
  EnergyOptions options;
  options.permutations = 20000;
  EXPECT_NEAR(energy_test(d, 3, options).p, double(extreme) / all, 0.015);
}

// Of two equal samples every permutation is as extreme; p is in (0, 1] always.
TEST(EnergyTest, EqualSamplesAreNoEvidence) {
  Random random(5);
  const Eigen::MatrixXd a = points(10, 3, random);
  EXPECT_GT(energy_test(distances(stacked(a, a)), 10).p, 0.9);
  EXPECT_EQ(energy_test(Eigen::MatrixXd::Zero(8, 8), 3).p, 1);
  EXPECT_EQ(energy_test(Eigen::MatrixXd::Zero(8, 8), 3).ratio, 0);
}

double uniform_gap(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  double gap = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    gap = std::max({gap, std::abs(double(i + 1) / double(p.size()) - p[i]),
                    std::abs(p[i] - double(i) / double(p.size()))});
  return gap;
}

// Under the null the p-values are uniform: Kolmogorov's bound at the level 0.001, for two samples
// of unlike sizes and heavy tails, and for three samples.
TEST(EnergyTest, PValuesAreUniformUnderTheNull) {
  constexpr int kTrials = 600;
  const double bound = 1.95 / std::sqrt(double(kTrials));
  for (const int samples : {2, 3}) {
    Random random(static_cast<std::uint64_t>(5 + samples));
    std::vector<double> p;
    for (int trial = 0; trial < kTrials; ++trial) {
      Eigen::MatrixXd x = points(22, 4, random);
      for (Eigen::Index i = 0; i < x.rows(); ++i) x.row(i) /= 0.2 + std::abs(random.normal());
      std::vector<int> groups(22, 0);
      for (std::size_t i = 8; i < 22; ++i) groups[i] = samples == 3 && i >= 14 ? 2 : 1;
      EnergyOptions options;
      options.permutations = 199;
      options.seed = static_cast<std::uint64_t>(trial);
      options.alpha = trial % 2 == 0 ? 1 : 0.7;
      p.push_back(disco_test(distances(x), groups, options).p);
    }
    EXPECT_LT(uniform_gap(p), bound) << samples;
  }
}

TEST(EnergyTest, FindsShiftsAndScales) {
  Random random(8);
  const Eigen::MatrixXd a = points(40, 3, random);
  EXPECT_LT(energy_test(distances(stacked(a, points(40, 3, random, 1, 0.8))), 40).p, 0.01);
  const Eigen::MatrixXd wide = distances(stacked(a, points(40, 3, random, 2.5)));
  EXPECT_LT(energy_test(wide, 40).p, 0.01);
}

TEST(EnergyTest, Repeats) {
  Random random(9);
  const Eigen::MatrixXd d = distances(points(30, 3, random));
  EnergyOptions options;
  options.seed = 7;
  EXPECT_EQ(energy_test(d, 13, options).p, energy_test(d, 13, options).p);
  // Which sample comes first is of no matter to what is measured.
  EXPECT_NEAR(energy_test(d, 13).statistic, energy_test(d.reverse(), 17).statistic, 1e-12);
}

TEST(EnergyTest, RefusesWhatIsNoDistance) {
  Random random(10);
  const Eigen::MatrixXd good = distances(points(6, 2, random));
  const auto with = [&](Eigen::Index i, Eigen::Index j, double value) {
    Eigen::MatrixXd d = good;
    d(i, j) = value;
    return refusal([&] { energy_test(d, 3); });
  };
  EXPECT_TRUE(contains(with(2, 1, std::nan("")), "2 and 1 is not finite"));
  EXPECT_TRUE(contains(with(2, 1, -1), "negative"));
  EXPECT_TRUE(contains(with(2, 1, good(2, 1) + 1), "another one way"));
  EXPECT_TRUE(contains(with(2, 2, 1), "expected 0"));
  EXPECT_TRUE(contains(refusal([&] { energy_test(good, 0); }), "samples of 0 and 6"));
  EXPECT_TRUE(contains(refusal([&] { energy_test(good, 6); }), "samples of 6 and 0"));
  EXPECT_TRUE(contains(refusal([&] { energy_test(good.leftCols(4), 2); }), "columns"));
  EXPECT_TRUE(contains(refusal([&] { disco_test(good, {0, 0, 0, 0, 0, 0}); }), "one sample"));
  EXPECT_TRUE(contains(refusal([&] { disco_test(good, {0, 0, 2, 2, 2, 2}); }), "empty"));
  EnergyOptions options;
  options.alpha = 2.5;
  EXPECT_TRUE(contains(refusal<UsageError>([&] { energy_test(good, 3, options); }), "alpha"));
}

}  // namespace
}  // namespace mocaplm::energy_tests
