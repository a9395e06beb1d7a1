#include "emulator/evaluation/two_level.h"

#include <memory>

#include "common/random.h"
#include "numeric/quantiles.h"

namespace mocaplm {

namespace {

std::string level_two_name(const std::string& level_one, const std::string& model) {
  return model == "PWI" ? model : level_one.substr(0, level_one.rfind('/') + 1) + model;
}

}  // namespace

std::vector<TwoLevelResult> two_level_simulation(const std::string& name,
                                                 const std::vector<PostureSequence>& fit,
                                                 const TwoLevelOptions& two_level,
                                                 const SchemeTestOptions& options) {
  SchemeOptions one = options.scheme, two = options.scheme;
  one.variance1 = one.variance2 = two.variance1 = two.variance2 = 0;
  one.d1 = two_level.one_d1;
  one.d2 = two_level.one_d2;
  two.d1 = two_level.two_d1;
  two.d2 = two_level.two_d2;
  std::vector<TwoLevelResult> results;
  for (const std::string& level_one : two_level.level_one) {
    const auto truth = fit_emulator(fit, parse_scheme(level_one), one, options.threads);
    // Samples are alike and independent: the last ones serve as a random part.
    std::vector<PostureSequence> train =
        truth->sample(static_cast<std::size_t>(two_level.sequences),
                      stable_hash(name + level_one + " level one", options.seed));
    const auto set_aside = static_cast<std::ptrdiff_t>(two_level.test);
    const std::vector<PostureSequence> test(train.end() - set_aside, train.end());
    train.resize(train.size() - test.size());
    const PackedPostures packed_test(test);
    const Eigen::MatrixXd within_test = sequence_distances(packed_test, options.threads);
    const std::vector<double> likelihood_test = likelihoods(*truth, test, options.threads);

    for (const std::string& model : two_level.level_two) {
      TwoLevelResult result;
      result.level_one = level_one;
      result.level_two = level_two_name(level_one, model);
      const auto emulator =
          fit_emulator(train, parse_scheme(result.level_two), two, options.threads);
      const std::vector<PostureSequence> samples =
          emulator->sample(static_cast<std::size_t>(two_level.test),
                           stable_hash(name + level_one + result.level_two, options.seed));
      const PackedPostures packed(samples);
      const Eigen::MatrixXd distances =
          joined_distances(sequence_distances(packed, options.threads), within_test,
                           cross_distances(packed, packed_test, options.threads));
      result.test = energy_test(distances, packed.count(), options.energy);
      result.likelihood_test = likelihood_test;
      result.likelihood_samples = likelihoods(*truth, samples, options.threads);
      result.likelihood_gap =
          compare_quantiles(result.likelihood_test, result.likelihood_samples, 2).gap;
      results.push_back(std::move(result));
    }
  }
  return results;
}

}  // namespace mocaplm
