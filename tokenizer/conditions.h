// What a model is told of a clip: the head of a window is the start token, then one condition token
// a label (thesis Figure 4.10).
#pragma once

#include <string>
#include <vector>

#include "tokenizer/tokenizer.h"

namespace mocaplm {

// Those of a clip's labels that a model has learned as conditions and whose value it knows.
Labels known_conditions(const Tokenizer& tokenizer, const std::vector<std::string>& conditions,
                        const Labels& labels);

// kStart, then for each of `conditions` the id of the clip's value, or kMask where the clip has
// none or the tokenizer does not know it.
std::vector<std::int32_t> condition_prefix(const Tokenizer& tokenizer,
                                           const std::vector<std::string>& conditions,
                                           const Labels& labels);

}  // namespace mocaplm
