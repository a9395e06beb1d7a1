// Choosing the next token from logits.
#pragma once

#include <string>
#include <vector>

#include "common/random.h"
#include "common/settings.h"

namespace mocaplm {

struct SamplingConfig {
  std::string strategy = "sample";
  double temperature = 1.0;
  std::int64_t top_k = 0;
  double top_p = 0.95;
  std::int64_t seed = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("strategy", strategy, {"sample", "greedy"}, "greedy takes the most likely token");
    v.number("temperature", temperature, 0.01, 100, "below 1 calmer, above 1 wilder");
    v.integer("top_k", top_k, 0, 100000, "sample among the k most likely tokens, 0 for all");
    v.number("top_p", top_p, 0.000001, 1,
             "sample among the most likely tokens that make up this probability");
    v.integer("seed", seed, 0, 2147483647, "seed of the random choices");
  }
};

class Sampler {
 public:
  // Throws UsageError for settings outside their ranges.
  explicit Sampler(const SamplingConfig& config);

  // One id out of [first, first + count), the ids that may come here. Throws DataError when one of
  // their logits is not finite.
  std::int32_t pick(const std::vector<float>& logits, std::int32_t first, std::int32_t count);
  // The same out of `allowed`, at least one id.
  std::int32_t pick(const std::vector<float>& logits, const std::vector<std::int32_t>& allowed);

 private:
  SamplingConfig config_;
  Random random_;
  std::vector<std::pair<double, std::int32_t>> candidates_;  // probability, id; reused
  std::vector<float> allowed_;                               // their logits; reused
};

}  // namespace mocaplm
