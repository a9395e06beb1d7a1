// What the model sees of a token stream: the tokens, their place in the frame, and the recent
// movement of each channel. Built here once, for training, evaluation and generation alike.
#pragma once

#include <cstdint>
#include <vector>

#include "model/config.h"

namespace mocaplm {

constexpr std::int32_t kNoCentre = -1000000;

// "frames": numbers that describe one channel of a frame (frame_features). With the bins b[t], the
// steps v[t] = b[t] - b[t-1] and their changes s[t] = v[t] - v[t-1] (0 where a frame is missing):
// the place u = (2 b + 1) / bins - 1 in the range; sin and cos of pi u, 2 pi u and 4 pi u;
// asinh(v[t]) / 2, asinh(s[t]) / 2, asinh(s[t-1]) / 2; and s[t] .. s[t-5], cut to +-8, / 4. The
// changes are what rounding to bins leaves of a smooth motion: a sum of the past ones tells where
// within its bin the channel is. A channel that training hides (joint_subset) has zeros.
constexpr std::int64_t kFrameLags = 6;
constexpr std::int64_t kFrameFeatures = 10 + kFrameLags;
constexpr int kMostChange = 8;

// One input of the model: T positions. Every vector has T entries.
struct ModelInput {
  std::vector<std::int32_t> token;  // id
  std::vector<std::int32_t>
      frame;  // row of the frame embedding: 0 prefix, 1.. frames of the window
  // Row of the channel embedding: channel, separator, prefix; of a piece the channel where it
  // begins + (channels + 2) (length - 1), so that the row also says which channel comes next.
  std::vector<std::int32_t> channel;
  // Bin that linear extrapolation 2x[t-1]-x[t-2] predicts for the *next* token (may lie outside the
  // bins), x[t-1] where only one frame precedes, kNoCentre where none does or the next token is no
  // bin.
  std::vector<std::int32_t> centre;
  // Rows of the three history embeddings, 0 where unknown: this token's distance from its
  // extrapolation; the next channel's last step x[t-1]-x[t-2]; the next channel's last distance
  // from its extrapolation.
  std::vector<std::int32_t> surprise, velocity, last_surprise;

  std::size_t size() const { return token.size(); }
};

// Positions [begin, end).
ModelInput slice(const ModelInput& input, std::size_t begin, std::size_t end);

// Reads the past of each channel out of a stream of whole frames (the last may be unfinished).
class StreamHistory {
 public:
  StreamHistory(const StreamShape& shape, std::int64_t reach) : shape_(shape), reach_(reach) {}

  // `index` may be ids.size(): the token that comes next.
  std::int32_t centre(const std::vector<std::int32_t>& ids, std::size_t index) const;
  std::int32_t surprise_row(const std::vector<std::int32_t>& ids, std::size_t index) const;
  std::int32_t velocity_row(const std::vector<std::int32_t>& ids, std::size_t index) const;
  std::int32_t last_surprise_row(const std::vector<std::int32_t>& ids, std::size_t index) const;

 private:
  // Bin of the token `frames` frames before `index`; kNoCentre when there is none.
  std::int32_t bin(const std::vector<std::int32_t>& ids, std::size_t index,
                   std::size_t frames) const;
  std::int32_t row(std::int64_t distance) const;

  StreamShape shape_;
  std::int64_t reach_;
};

// Appends one position: prefix tokens first, then stream tokens from `first` (the start of a frame)
// on. `next` is the index in `ids` of the token that this position predicts.
void append_prefix(ModelInput& input, const ModelDescription& model, std::int32_t token, bool last,
                   const std::vector<std::int32_t>& ids, std::size_t first);
void append_stream(ModelInput& input, const ModelDescription& model,
                   const std::vector<std::int32_t>& ids, std::size_t first, std::size_t index);
// The same for `token`, which stands for the `length` characters from `index` on; `ids` are
// characters. Its frame, channel and surprise are its first character's; what is told of the next
// token is of the next character.
void append_piece(ModelInput& input, const ModelDescription& model,
                  const std::vector<std::int32_t>& ids, std::size_t first, std::size_t index,
                  std::int32_t token, std::size_t length);

// Prefix, then `count` tokens of `ids` from `first` (a multiple of tokens_per_frame) on.
ModelInput window_input(const ModelDescription& model, const std::vector<std::int32_t>& prefix,
                        const std::vector<std::int32_t>& ids, std::size_t first, std::size_t count);

// A stream told in pieces: `tokens` begin at the characters `starts` of `ids` (one more entry: the
// end).
struct PieceTokens {
  const std::vector<std::int32_t>& ids;
  const std::vector<std::int32_t>& tokens;
  const std::vector<std::size_t>& starts;
};
// Prefix, then `count` tokens from `first` on, which begins a frame.
ModelInput piece_window_input(const ModelDescription& model,
                              const std::vector<std::int32_t>& prefix, const PieceTokens& stream,
                              std::size_t first, std::size_t count);

}  // namespace mocaplm
