// A dataset as token streams, and the windows that training sees of it.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "common/random.h"
#include "model/input.h"
#include "motion/dataset.h"
#include "tokenizer/piece_vocabulary.h"
#include "tokenizer/tokenizer.h"
#include "train/masking.h"

namespace mocaplm {

struct EncodedClip {
  std::string name;
  std::vector<std::int32_t> ids;     // whole frames, a character a channel
  PieceStream pieces;                // the same in pieces, where the model speaks them
  std::vector<std::int32_t> labels;  // condition tokens in the model's order; kMask where not known
  Labels values;                     // the labels themselves
  double weight = 1;                 // of a frame, when windows are drawn (train/balance.h)
};

struct Corpus {
  std::vector<EncodedClip> clips;
  std::int64_t frames = 0;
  std::int64_t left_out = 0;  // clips shorter than 3 frames
  EncodeReport report;
};

// What clips become tokens by.
struct StreamEncoding {
  const Tokenizer& tokenizer;
  const std::vector<std::string>& conditions;
  const PieceVocabulary* pieces = nullptr;  // null, or one without any: a character a token
};

// Random changes of the clips, the same for the same seed.
struct Augmentation {
  bool heading = false;  // turned about the vertical by any angle
  double speed = 1;      // played at a rate between 1 / speed and speed (uniform in its logarithm)
  std::uint64_t seed = 0;
  bool any() const { return heading || speed > 1; }
};

// A clip as it is changed; `name` tells clips (and mirrored twins) apart.
Clip augmented(const Clip& clip, const std::string& name, const Augmentation& augmentation);

// Encodes the clips of one split on all cores. With `mirror` each clip is there a second time,
// mirrored. When `stop` becomes true the rest is left out. Throws DataError when the split is empty
// or a clip is shorter than 3 frames at the tokenizer's rate (those are counted and left out) and
// nothing else is left.
Corpus encode_split(const Dataset& dataset, const std::string& split,
                    const StreamEncoding& encoding, bool mirror, int threads,
                    const Augmentation& augmentation = {}, const std::atomic<bool>* stop = nullptr);
inline Corpus encode_split(const Dataset& dataset, const std::string& split,
                           const Tokenizer& tokenizer, const std::vector<std::string>& conditions,
                           bool mirror, int threads, const Augmentation& augmentation = {},
                           const std::atomic<bool>* stop = nullptr) {
  return encode_split(dataset, split, {tokenizer, conditions}, mirror, threads, augmentation, stop);
}
// Tokens of a frame that have a loss, on average over a corpus.
double predicted_per_frame(const Corpus& corpus, const ModelDescription& model);

struct Window {
  ModelInput input;
  // The next id at each position, of a masked model the position's own where it is hidden; -1 where
  // the loss ignores it.
  std::vector<std::int32_t> target;
  std::size_t clip = 0, first_frame = 0, frames = 0;
  std::size_t size = 0;  // positions before the padding
};

// One window of `tokens_in_window` tokens (padded when the clip is shorter), starting at
// a frame. `reserve` positions are left free at the end (classification tokens).
Window make_window(const Corpus& corpus, const ModelDescription& model, std::size_t clip,
                   std::size_t first_frame, const WindowOptions& options, Random& random,
                   std::int64_t reserve = 0);

// Whole frames that fit a window beside its prefix.
std::size_t window_frames(const ModelDescription& model, std::int64_t reserve = 0);

// Draws windows so that a clip is as likely as it is long (times its weight), then a start
// uniformly.
class WindowSampler {
 public:
  WindowSampler(const Corpus& corpus, const ModelDescription& model);
  Window draw(Random& random, const WindowOptions& options) const;

 private:
  const Corpus& corpus_;
  const ModelDescription& model_;
  std::vector<double> cumulative_;  // weights up to and including each clip
};

// Windows spread evenly over the corpus, always the same (of a masked model also what is hidden):
// for validation.
std::vector<Window> even_windows(const Corpus& corpus, const ModelDescription& model,
                                 std::int64_t count);

}  // namespace mocaplm
