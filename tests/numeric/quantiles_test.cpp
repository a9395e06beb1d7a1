#include "numeric/quantiles.h"
#include "numeric/distributions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/random.h"

namespace mocaplm::quantiles_test {
namespace {

TEST(NormalQuantile, IsTheInverseAndAsTabled) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-9);
  EXPECT_NEAR(normal_quantile(0.5), 0, 1e-12);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232306167813, 1e-9);
  EXPECT_NEAR(normal_quantile(1e-10), -6.361340902404056, 1e-8);
  for (double p = 0.001; p < 1; p += 0.0137) {
    EXPECT_NEAR(normal_cdf(normal_quantile(p)), p, 1e-10);
    EXPECT_NEAR(normal_quantile(p), -normal_quantile(1 - p), 1e-9);
  }
}

TEST(SampleQuantile, IsBetweenTheMembers) {
  const std::vector<double> sample = {1, 2, 4, 8};
  EXPECT_EQ(sample_quantile(sample, 0), 1);
  EXPECT_EQ(sample_quantile(sample, 1), 8);
  EXPECT_NEAR(sample_quantile(sample, 0.5), 3, 1e-12);
  EXPECT_EQ(median_of({9, 1, 5}), 5);
}

std::vector<double> normal_sample(int count, std::uint64_t seed, double power = 1) {
  Random random(seed);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    values.push_back(3 + 2 * std::copysign(std::pow(std::abs(x), power), x));
  }
  return values;
}

TEST(NormalPlot, IsStraightForNormalSamplesOnly) {
  const NormalPlot normal = normal_plot(normal_sample(400, 1));
  EXPECT_GT(normal.correlation, 0.995);
  EXPECT_LT(normal.lilliefors, 0.052);  // the 1 % point, 1.035 / sqrt(n)
  const NormalPlot heavy = normal_plot(normal_sample(400, 2, 2.5));
  EXPECT_LT(heavy.correlation, 0.92);
  EXPECT_GT(heavy.lilliefors, 0.1);
  ASSERT_EQ(normal.points.size(), 400u);
  for (std::size_t i = 1; i < 400; ++i) {
    EXPECT_LE(normal.points[i - 1].first, normal.points[i].first);
    EXPECT_LE(normal.points[i - 1].second, normal.points[i].second);
  }
}

TEST(NormalPlot, OfTooLittleIsEmpty) {
  EXPECT_TRUE(normal_plot({1, 2}).points.empty());
  EXPECT_TRUE(normal_plot({4, 4, 4, 4}).points.empty());
  EXPECT_EQ(normal_plot({4, 4, 4, 4}).correlation, 1);
}

TEST(CompareQuantiles, OfAShiftIsALineAside) {
  const std::vector<double> a = normal_sample(50, 3);
  std::vector<double> b = a;
  for (double& value : b) value += 1.5;
  const QuantileComparison comparison = compare_quantiles(a, b, 20);
  ASSERT_EQ(comparison.points.size(), 20u);
  for (const auto& [x, y] : comparison.points) EXPECT_NEAR(y - x, 1.5, 1e-12);
  EXPECT_EQ(compare_quantiles(a, a, 5).gap, 0);
}

TEST(CompareQuantiles, GapIsThatOfTheDistributionFunctions) {
  const std::vector<double> a = normal_sample(37, 4), b = normal_sample(61, 5, 1.5);
  double gap = 0;
  for (const std::vector<double>* sample : {&a, &b})
    for (const double at : *sample) {
      const auto below = [&](const std::vector<double>& values) {
        return double(std::count_if(values.begin(), values.end(),
                                    [&](double value) { return value <= at; })) /
               double(values.size());
      };
      gap = std::max(gap, std::abs(below(a) - below(b)));
    }
  EXPECT_NEAR(compare_quantiles(a, b, 3).gap, gap, 1e-12);
}

}  // namespace
}  // namespace mocaplm::quantiles_test
