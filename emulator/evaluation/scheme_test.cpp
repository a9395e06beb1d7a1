#include "emulator/evaluation/scheme_test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "common/parallel.h"
#include "common/random.h"
#include "numeric/quantiles.h"

namespace mocaplm {

namespace {

using Eigen::Index;

void test_normality(const Emulator& emulator, const std::vector<PostureSequence>& fit,
                    SchemeResult& result) {
  const std::string& reduction = emulator.scheme().reduction;
  if (reduction != "SequentialPCA" && reduction != "MPCA") return;
  std::vector<Eigen::VectorXd> coefficients;
  for (const PostureSequence& sequence : fit)
    coefficients.push_back(emulator.coefficients(sequence));
  std::vector<double> correlations;
  for (Index k = 0; k < coefficients[0].size(); ++k) {
    std::vector<double> values;
    for (const Eigen::VectorXd& one : coefficients) values.push_back(one[k]);
    const NormalPlot plot = normal_plot(values);
    if (!plot.points.empty()) correlations.push_back(plot.correlation);
  }
  if (correlations.empty()) return;
  result.normal_least = *std::min_element(correlations.begin(), correlations.end());
  result.normal_median = median_of(correlations);
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

void compare_likelihoods(const Emulator& emulator, const ClassMotions& motions, int threads,
                         SchemeResult& result) {
  result.likelihood_fit = likelihoods(emulator, motions.fit(), threads);
  result.likelihood_test = likelihoods(emulator, motions.test(), threads);
  result.likelihood_samples = likelihoods(emulator, result.samples, threads);
  result.likelihood_gap = 1;
  if (all_finite(result.likelihood_test) && all_finite(result.likelihood_samples))
    result.likelihood_gap =
        compare_quantiles(result.likelihood_test, result.likelihood_samples, 2).gap;
}

void compare_distances(const ClassMotions& motions, const SchemeTestOptions& options,
                       SchemeResult& result) {
  const PackedPostures packed(result.samples);
  result.sample_distances = sequence_distances(packed, options.threads);
  result.to_test = cross_distances(packed, motions.packed_test(), options.threads);
  result.to_fit = cross_distances(packed, motions.packed_fit(), options.threads);
  result.unseen = energy_test(
      joined_distances(result.sample_distances, motions.test_distances(), result.to_test),
      packed.count(), options.energy);
  result.fitted =
      energy_test(joined_distances(result.sample_distances, motions.fit_distances(), result.to_fit),
                  packed.count(), options.energy);
  result.spread = mean_pair(result.sample_distances) / mean_pair(motions.test_distances());
  result.nearest = median_nearest(result.to_fit) / median_nearest(motions.cross());
}

}  // namespace

std::vector<double> likelihoods(const Emulator& emulator,
                                const std::vector<PostureSequence>& sequences, int threads) {
  std::vector<double> all(sequences.size());
  parallel_for(sequences.size(), threads, [&](std::size_t i) {
    const auto d = static_cast<double>(emulator.coefficients(sequences[i]).size());
    all[i] = emulator.log_likelihood(sequences[i]) / std::max(1.0, d);
  });
  return all;
}

ClassMotions::ClassMotions(std::string name, std::vector<PostureSequence> fit,
                           std::vector<PostureSequence> test, int threads)
    : name_(std::move(name)),
      fit_(std::move(fit)),
      test_(std::move(test)),
      packed_fit_(fit_),
      packed_test_(test_),
      fit_distances_(sequence_distances(packed_fit_, threads)),
      test_distances_(sequence_distances(packed_test_, threads)),
      cross_(cross_distances(packed_test_, packed_fit_, threads)) {}

Eigen::MatrixXd joined_distances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                 const Eigen::MatrixXd& between) {
  Eigen::MatrixXd all(a.rows() + b.rows(), a.rows() + b.rows());
  all << a, between, between.transpose(), b;
  return all;
}

double mean_pair(const Eigen::MatrixXd& distances) {
  const auto n = static_cast<double>(distances.rows());
  return n > 1 ? (distances.sum() - distances.trace()) / (n * (n - 1)) : 0;
}

double median_nearest(const Eigen::MatrixXd& distances, bool without_self) {
  std::vector<double> nearest;
  for (Index i = 0; i < distances.rows(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (Index j = 0; j < distances.cols(); ++j)
      if (!without_self || i != j) least = std::min(least, distances(i, j));
    nearest.push_back(least);
  }
  return nearest.empty() ? 0 : median_of(nearest);
}

QuantisedResult test_quantised(const std::vector<Symbols>& sample, const std::vector<Symbols>& fit,
                               const Symbols& mean, int clusters,
                               const QuantisedSettings& settings) {
  QuantisedResult result;
  result.variability = variability(sample, mean);
  const auto real = transition_matrices(fit, clusters, settings.window, settings.step);
  const auto own = transition_matrices(sample, clusters, settings.window, settings.step);
  result.windows = real.size();
  result.transitions = transition_difference(real, own);
  result.baseline = transition_difference(real, uniform_transitions(real.size(), clusters));
  return result;
}

SchemeResult test_scheme(const ClassMotions& motions, const Scheme& scheme,
                         const SchemeTestOptions& options) {
  SchemeResult result;
  result.scheme = to_string(scheme);
  const std::unique_ptr<Emulator> emulator =
      fit_emulator(motions.fit(), scheme, options.scheme, options.threads);
  result.d1 = emulator->d1();
  result.d2 = emulator->d2();
  result.samples = emulator->sample(static_cast<std::size_t>(options.samples),
                                    stable_hash(motions.name() + result.scheme, options.seed));
  const auto finite_end =
      std::remove_if(result.samples.begin(), result.samples.end(),
                     [](const PostureSequence& s) { return !s.values.allFinite(); });
  result.diverged = static_cast<std::size_t>(result.samples.end() - finite_end);
  result.samples.erase(finite_end, result.samples.end());
  test_normality(*emulator, motions.fit(), result);
  if (result.samples.size() < 2) {
    result.unseen.p = result.fitted.p = 0;
    return result;
  }
  compare_distances(motions, options, result);
  compare_likelihoods(*emulator, motions, options.threads, result);
  result.steps = mean_steps(result.samples);
  result.roughness = result.steps.mean() / mean_steps(motions.test()).mean();
  return result;
}

}  // namespace mocaplm
