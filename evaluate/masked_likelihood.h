// How many bits a masked model needs for tokens that are hidden from it.
#pragma once

#include "evaluate/likelihood.h"

namespace mocaplm {

// Every token but the separators is hidden once, a seventh of the tokens at a time (0.143, the
// thesis hides 0.15; which ones is drawn once and for all), and scored given all others of a window
// in whose middle it lies. Columns as score_clips; separators cost nothing. The sum is no
// description length: each token is told with others that come after it (a pseudo-likelihood), so
// it compares with no causal model's bits.
std::vector<BitCount> score_masked_clips(LanguageModel& model, const std::vector<ScoredClip>& clips,
                                         std::int64_t windows_at_once,
                                         const WindowsDone& progress = nullptr);

// The pass, 0 to 6, in which each token of a clip is hidden; -1 for separators. What the above
// uses.
std::vector<int> masking_passes(const StreamShape& shape, std::size_t tokens, std::size_t clip);
constexpr int kMaskingPasses = 7;

}  // namespace mocaplm
