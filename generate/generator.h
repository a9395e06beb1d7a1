// From a prompt to a dance (thesis 4.6): prompted channels are kept as given, all others are filled
// in one token after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "generate/engine.h"
#include "generate/sampler.h"
#include "motion/clip.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

struct GenerateRequest {
  std::optional<Clip> prompt;  // at any rate: resampled to the tokenizer's
  std::vector<int> joints;     // prompted joints; empty: the prompt is continued as a whole
  Labels labels;               // conditions; those left out are left open
  double seconds = 10;         // length of the result
  double prompt_seconds = 0;   // use only this much of the prompt; 0: all of it
  SamplingConfig sampling;
};

struct GenerateResult {
  Clip clip;                // at the tokenizer's rate, labelled with the conditions
  Clip context;             // the prompt at the same rate and length of use (empty without one)
  std::vector<int> joints;  // prompted joints that the model has
  std::vector<std::string> notes;  // what the user should know (resampled, joints left free, ...)
  double frozen = 0;               // share of frames in which nothing moves more than one bin
  double context_frozen = 0;       // the same of the prompt
};

class Generator {
 public:
  // Throws DataError when model and tokenizer do not belong together.
  Generator(const StoredModel& model, const std::string& place);

  // Throws UsageError for joints the model does not have and requests that cannot be, DataError for
  // labels it does not know, each with what it does know. `progress(frames done, frames)` is called
  // after every frame.
  GenerateResult generate(const GenerateRequest& request,
                          const std::function<void(std::size_t, std::size_t)>& progress = nullptr);

  const Tokenizer& tokenizer() const { return tokenizer_; }
  const ModelDescription& description() const { return engine_.description(); }

 private:
  struct Plan;
  Plan plan(const GenerateRequest& request, GenerateResult& result) const;
  std::vector<std::int32_t> prefix(const Labels& labels) const;
  void refill(const std::vector<std::int32_t>& prefix, const std::vector<std::int32_t>& ids);

  Engine engine_;
  Tokenizer tokenizer_;
  std::size_t first_ = 0;  // index of the first stream token in the cache, a frame's start
};

// Share of frames, from the second on, in which no rotation channel moves by more than one bin.
double frozen_share(const std::vector<std::int32_t>& ids, const Tokenizer& tokenizer);

}  // namespace mocaplm
