// How many bits a model needs for motion that it has not seen (the thesis's bits/frame).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluate/baselines.h"
#include "generate/decoder.h"
#include "model/transformer/language_model.h"
#include "motion/clip.h"
#include "tokenizer/piece_vocabulary.h"

namespace mocaplm {

struct ScoredClip {
  std::vector<std::int32_t> ids;     // whole frames
  std::vector<std::int32_t> prefix;  // start and condition tokens
  PieceStream pieces = {};           // the frames in pieces, where the model speaks them
};

using WindowsDone = std::function<void(std::size_t, std::size_t)>;

// Bits of every frame of every clip, channels + 1 columns (the separator last). Each frame is
// scored once, in a window that shows at least half of the context before it (less only at a clip's
// beginning). `progress` gets the number of windows done and their total.
std::vector<BitCount> score_clips(LanguageModel& model, const std::vector<ScoredClip>& clips,
                                  std::int64_t windows_at_once,
                                  const WindowsDone& progress = nullptr);
// The same of a model of pieces (score_clips calls it): the bits of a piece are shared equally by
// the channels that it covers, and the separator has some only where it is a token of its own. Each
// frame is told in the pieces that training cuts it into; the model could tell it in others, too,
// so that these bits are an upper bound of what the frame costs.
std::vector<BitCount> score_piece_clips(LanguageModel& model, const std::vector<ScoredClip>& clips,
                                        std::int64_t windows_at_once,
                                        const WindowsDone& progress = nullptr);
// The same as score_clips token by token through the decoder that generates, as many windows at
// once as it has sequences: what its precision costs. Separators, which it never chooses, cost
// nothing.
std::vector<BitCount> score_clips(Decoder& decoder, const std::vector<ScoredClip>& clips,
                                  const WindowsDone& progress = nullptr);

}  // namespace mocaplm
