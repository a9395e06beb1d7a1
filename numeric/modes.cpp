#include "numeric/modes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "common/error.h"

namespace mocaplm {

namespace {

using Eigen::Index;

// How dense the sample is around each member: neighbours within epsilon; among equals the one that
// lies nearer to its neighbours is the more central.
struct Density {
  std::vector<Index> neighbours;
  std::vector<double> spread;

  bool above(Index a, Index b) const {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    if (neighbours[i] != neighbours[j]) return neighbours[i] > neighbours[j];
    if (spread[i] != spread[j]) return spread[i] < spread[j];
    return a < b;
  }
};

Density density_of(const Eigen::MatrixXf& d, float epsilon) {
  Density density;
  for (Index i = 0; i < d.cols(); ++i) {
    const float* column = d.data() + i * d.rows();
    Index count = 0;
    double spread = 0;
    for (Index j = 0; j < d.rows(); ++j) {
      const bool near = column[j] <= epsilon;
      count += near;
      spread += near ? static_cast<double>(column[j]) : 0;
    }
    density.neighbours.push_back(count);
    density.spread.push_back(spread);
  }
  return density;
}

std::vector<Index> modes_at(const Eigen::MatrixXf& d, float epsilon, const ModeOptions& options) {
  const Density density = density_of(d, epsilon);
  const double least = std::max(2.0, options.smallest * static_cast<double>(d.rows()));
  std::vector<Index> modes;
  for (Index i = 0; i < d.cols(); ++i) {
    bool is_mode = static_cast<double>(density.neighbours[static_cast<std::size_t>(i)]) >= least;
    for (Index j = 0; is_mode && j < d.rows(); ++j)
      is_mode = j == i || d(j, i) > epsilon || density.above(i, j);
    if (is_mode) modes.push_back(i);
  }
  std::sort(modes.begin(), modes.end(), [&](Index a, Index b) { return density.above(a, b); });
  return modes;
}

std::vector<int> nearest(const Eigen::MatrixXf& d, const std::vector<Index>& modes) {
  std::vector<int> cluster(static_cast<std::size_t>(d.rows()), 0);
  for (Index i = 0; i < d.rows(); ++i)
    for (std::size_t k = 1; k < modes.size(); ++k) {
      int& best = cluster[static_cast<std::size_t>(i)];
      if (d(i, modes[k]) < d(i, modes[static_cast<std::size_t>(best)])) best = static_cast<int>(k);
    }
  return cluster;
}

double anova_ratio(const Eigen::MatrixXf& d, const std::vector<int>& cluster, std::size_t k) {
  if (k < 2) return 0;
  const auto n = static_cast<double>(d.rows());
  std::vector<double> squares(k, 0), sizes(k, 0);
  std::vector<double> row(k);
  double all = 0;
  for (Index i = 0; i < d.cols(); ++i) {
    const float* column = d.data() + i * d.rows();
    std::fill(row.begin(), row.end(), 0);
    for (Index j = 0; j < i; ++j)
      row[static_cast<std::size_t>(cluster[static_cast<std::size_t>(j)])] +=
          static_cast<double>(column[j]) * static_cast<double>(column[j]);
    all += std::accumulate(row.begin(), row.end(), 0.0);
    const auto own = static_cast<std::size_t>(cluster[static_cast<std::size_t>(i)]);
    squares[own] += row[own];
    sizes[own] += 1;
  }
  double within = 0;
  for (std::size_t c = 0; c < k; ++c) within += sizes[c] > 0 ? squares[c] / sizes[c] : 0;
  const double freedom = n - static_cast<double>(k);
  if (!(within > 0) || freedom <= 0) return std::numeric_limits<double>::infinity();
  return (all / n - within) / static_cast<double>(k - 1) / (within / freedom);
}

// Rising, different values of epsilon: quantiles of (at most some 200,000 of) the distances, evenly
// in their square root, for clusters are found among the small ones.
std::vector<float> epsilons(const Eigen::MatrixXf& d, int grid) {
  std::vector<float> sample;
  const auto pairs = static_cast<std::uint64_t>(d.rows()) * static_cast<std::uint64_t>(d.rows());
  const std::uint64_t stride = std::max<std::uint64_t>(1, pairs / 200000) | 1;
  for (std::uint64_t at = 0; at < pairs; at += stride)
    if (d.data()[at] > 0) sample.push_back(d.data()[at]);
  std::sort(sample.begin(), sample.end());
  std::vector<float> values;
  for (int i = 0; i < grid && !sample.empty(); ++i) {
    const double root = (i + 0.5) / grid;
    const float value = sample[static_cast<std::size_t>(0.7 * root * root *
                                                        static_cast<double>(sample.size() - 1))];
    if (values.empty() || value > values.back()) values.push_back(value);
  }
  return values;
}

// The trial that wins (see the header).
const ModeTrial* choose(const std::vector<ModeTrial>& trials, const ModeOptions& options) {
  const ModeTrial* best = nullptr;
  const auto wanted = [&](const ModeTrial& trial) { return std::abs(trial.modes - options.count); };
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const ModeTrial& trial = trials[i];
    if (options.count > 0) {
      if (trial.modes >= 1 && (best == nullptr || wanted(trial) < wanted(*best) ||
                               (wanted(trial) == wanted(*best) && trial.ratio > best->ratio)))
        best = &trial;
      continue;
    }
    std::size_t begin = i, end = i + 1;
    while (begin > 0 && trials[begin - 1].modes == trial.modes) --begin;
    while (end < trials.size() && trials[end].modes == trial.modes) ++end;
    const bool agreed = end - begin >= static_cast<std::size_t>(options.stable);
    if (agreed && trial.modes >= 2 && trial.modes <= options.most &&
        (best == nullptr || trial.ratio > best->ratio))
      best = &trial;
  }
  return best;
}

}  // namespace

Modes find_modes(const Eigen::MatrixXf& distance, const ModeOptions& options) {
  if (distance.rows() != distance.cols() || distance.rows() < 1 || !distance.allFinite() ||
      distance.minCoeff() < 0)
    throw DataError(in_file("clusters"),
                    "the distances are not a square matrix of finite numbers from 0 on");
  Modes result;
  std::vector<std::vector<Index>> found;
  for (const float epsilon : epsilons(distance, options.grid)) {
    found.push_back(modes_at(distance, epsilon, options));
    const std::vector<Index>& modes = found.back();
    ModeTrial trial{static_cast<double>(epsilon), static_cast<Index>(modes.size()), 0};
    if (modes.size() >= 2 && static_cast<int>(modes.size()) <= options.most)
      trial.ratio = anova_ratio(distance, nearest(distance, modes), modes.size());
    result.trials.push_back(trial);
  }
  if (const ModeTrial* best = choose(result.trials, options)) {
    result.modes = found[static_cast<std::size_t>(best - result.trials.data())];
    result.epsilon = best->epsilon;
    result.ratio = best->ratio;
  } else {
    // One cluster; its mode is the most central member of all.
    Index centre = 0;
    distance.colwise().sum().minCoeff(&centre);
    result.modes = {centre};
  }
  result.cluster = nearest(distance, result.modes);
  return result;
}

}  // namespace mocaplm
