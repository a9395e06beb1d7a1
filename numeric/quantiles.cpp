#include "numeric/quantiles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "numeric/distributions.h"
#include "numeric/lilliefors.h"

namespace mocaplm {

double normal_quantile(double p) {
  assert(p > 0 && p < 1);
  // A first guess (Abramowitz and Stegun 26.2.23, error under 5e-4), then Newton's steps.
  const double tail = std::min(p, 1 - p);
  const double t = std::sqrt(-2 * std::log(tail));
  double x = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                     (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  constexpr double kRootTwoPi = 2.5066282746310002;
  // On the upper tail, so that small shares keep their digits.
  for (int i = 0; i < 3; ++i) x += (normal_cdf(-x) - tail) * kRootTwoPi * std::exp(0.5 * x * x);
  return p < 0.5 ? -x : x;
}

double sample_quantile(const std::vector<double>& sorted, double p) {
  assert(!sorted.empty());
  const double place = std::clamp(p, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return sample_quantile(values, 0.5);
}

NormalPlot normal_plot(std::vector<double> values) {
  NormalPlot plot;
  const auto n = static_cast<double>(values.size());
  if (values.size() < 3) return plot;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double deviation = std::sqrt(squares / (n - 1));
  if (!(deviation > 1e-12 * (1 + std::abs(mean)))) return plot;
  std::sort(values.begin(), values.end());
  double both = 0, expected_squares = 0, value_squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double rank = static_cast<double>(i + 1);
    const double expected = normal_quantile((rank - 0.375) / (n + 0.25));
    const double value = (values[i] - mean) / deviation;
    plot.points.emplace_back(expected, value);
    both += expected * value;
    expected_squares += expected * expected;
    value_squares += value * value;
  }
  plot.lilliefors = lilliefors_statistic(
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  plot.correlation = both / std::sqrt(expected_squares * value_squares);
  return plot;
}

QuantileComparison compare_quantiles(std::vector<double> a, std::vector<double> b,
                                     std::size_t count) {
  assert(!a.empty() && !b.empty());
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  QuantileComparison comparison;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    comparison.points.emplace_back(sample_quantile(a, share), sample_quantile(b, share));
  }
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    const double at = std::min(a[i], b[j]);
    while (i < a.size() && a[i] <= at) ++i;
    while (j < b.size() && b[j] <= at) ++j;
    comparison.gap =
        std::max(comparison.gap, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                          static_cast<double>(j) / static_cast<double>(b.size())));
  }
  return comparison;
}

}  // namespace mocaplm
