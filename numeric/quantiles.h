// Samples beside each other, and beside a normal distribution, by their quantiles.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace mocaplm {

// The x that a share p in (0, 1) of the normal distribution lies below (to 1e-9).
double normal_quantile(double p);

// The value that a share p in [0, 1] of the sample lies below, between members linearly
// (Hyndman and Fan's definition 7). `sorted` ascending, not empty.
double sample_quantile(const std::vector<double>& sorted, double p);
double median_of(std::vector<double> values);

struct NormalPlot {
  // (expected, standardised value): normal quantiles at (i - 3/8) / (n + 1/4) (Blom 1958), values
  // ascending, less their mean and by their standard deviation.
  std::vector<std::pair<double, double>> points;
  double correlation = 1;  // of these pairs: 1 for a perfect normal sample (Filliben 1975)
  double lilliefors = 0;  // largest gap of the distribution functions, mean and deviation estimated
};

// A sample of fewer than 3 or without variance has no plot: no points, 1 and 0.
NormalPlot normal_plot(std::vector<double> values);

struct QuantileComparison {
  std::vector<std::pair<double, double>> points;  // quantiles of a and b at the same shares
  double gap =
      0;  // largest gap of their distribution functions (Kolmogorov and Smirnov), in [0, 1]
};

// At (i - 1/2) / count shares; neither sample empty.
QuantileComparison compare_quantiles(std::vector<double> a, std::vector<double> b,
                                     std::size_t count);

}  // namespace mocaplm
