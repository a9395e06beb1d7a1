// What a request asks of the token stream: how many frames, and which tokens are given.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "generate/sampler.h"
#include "model/config.h"
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

constexpr std::int32_t kFree = -1;  // a token that is to be filled in

struct GeneratePlan {
  std::size_t frames = 0;           // of the result
  std::vector<std::int32_t> given;  // as far as the prompt reaches: ids, or kFree
  Clip prompt;                      // at the tokenizer's rate, the part that is used
  std::vector<int> kept;            // joints that are the prompt's own, not their bins
  std::vector<int> joints;          // prompted joints that the model has
  std::vector<std::string> notes;   // what the user should know (resampled, joints left free, ...)
  double prompt_frozen = 0;         // frozen_share of the prompt
};

// Throws UsageError for joints that the model does not have and requests that cannot be.
GeneratePlan plan_generation(const GenerateRequest& request, const Tokenizer& tokenizer);

// The tokens that head each window: start, then one for each condition. Throws DataError for labels
// that the model does not know, with those it does.
std::vector<std::int32_t> condition_prefix(const Labels& labels, const ModelDescription& model,
                                           const Tokenizer& tokenizer);

// Share of frames, from the second on, in which no rotation channel moves by more than one bin.
double frozen_share(const std::vector<std::int32_t>& ids, const Tokenizer& tokenizer);

}  // namespace mocaplm
