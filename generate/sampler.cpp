#include "generate/sampler.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/error.h"

namespace mocaplm {

Sampler::Sampler(const SamplingConfig& config) : random_(static_cast<std::uint64_t>(config.seed)) {
  try {
    const Json settings = settings_json(config);
    JsonObject object(settings, "sampling");
    read_settings(config_, object);  // checks every range
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
}

std::int32_t Sampler::pick(const std::vector<float>& logits, std::int32_t first,
                           std::int32_t count) {
  assert(count > 0 && first >= 0 &&
         static_cast<std::size_t>(first) + static_cast<std::size_t>(count) <= logits.size());
  const auto begin = logits.begin() + first, end = begin + count;
  if (!std::all_of(begin, end, [](float logit) { return std::isfinite(logit); }))
    throw DataError(in_file("the model"),
                    "gives logits that are not finite: its weights are damaged "
                    "or its training went wrong");
  const auto best = std::max_element(begin, end);
  if (config_.strategy == "greedy") return static_cast<std::int32_t>(best - logits.begin());
  candidates_.clear();
  double total = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    const double p = std::exp((static_cast<double>(begin[i]) - *best) / config_.temperature);
    candidates_.emplace_back(p, first + i);
    total += p;
  }
  // Most likely first; equal ones by id, so that the order is the same everywhere.
  std::sort(candidates_.begin(), candidates_.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  if (config_.top_k > 0 && static_cast<std::size_t>(config_.top_k) < candidates_.size())
    candidates_.resize(static_cast<std::size_t>(config_.top_k));
  double kept = 0;
  std::size_t size = 0;
  while (size < candidates_.size() && (size == 0 || kept < config_.top_p * total))
    kept += candidates_[size++].first;
  double at = random_.uniform() * kept;
  for (std::size_t i = 0; i < size; ++i)
    if ((at -= candidates_[i].first) < 0) return candidates_[i].second;
  return candidates_[size - 1].second;
}

std::int32_t Sampler::pick(const std::vector<float>& logits,
                           const std::vector<std::int32_t>& allowed) {
  allowed_.clear();
  for (const std::int32_t id : allowed) allowed_.push_back(logits[static_cast<std::size_t>(id)]);
  return allowed[static_cast<std::size_t>(
      pick(allowed_, 0, static_cast<std::int32_t>(allowed.size())))];
}

}  // namespace mocaplm
