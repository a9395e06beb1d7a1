// How many bits a model needs for motion that it has not seen (the thesis's bits/frame).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluate/baselines.h"
#include "generate/decoder.h"
#include "model/transformer/language_model.h"
#include "motion/clip.h"

namespace mocaplm {

struct ScoredClip {
  std::vector<std::int32_t> ids;     // whole frames
  std::vector<std::int32_t> prefix;  // start and condition tokens
};

using WindowsDone = std::function<void(std::size_t, std::size_t)>;

// Bits of every frame of every clip, channels + 1 columns (the separator last). Each frame is
// scored once, in a window that shows at least half of the context before it (less only at a clip's
// beginning). `progress` gets the number of windows done and their total.
std::vector<BitCount> score_clips(LanguageModel& model, const std::vector<ScoredClip>& clips,
                                  std::int64_t windows_at_once,
                                  const WindowsDone& progress = nullptr);
// The same token by token through the decoder that generates, as many windows at once as it has
// sequences: what its precision costs. Separators, which it never chooses, cost nothing.
std::vector<BitCount> score_clips(Decoder& decoder, const std::vector<ScoredClip>& clips,
                                  const WindowsDone& progress = nullptr);

}  // namespace mocaplm
