// What a model is: the settings of its transformer and the token stream it was made for.
#pragma once

#include <string>
#include <vector>

#include "common/settings.h"

namespace mocaplm {

struct ModelConfig {
  std::string architecture = "flat";
  std::string objective = "causal";
  std::int64_t n_layer = 4;
  std::int64_t n_head = 4;
  std::int64_t n_embd = 192;
  std::int64_t block_size = 1024;
  double dropout = 0.1;
  std::string position = "custom";
  std::string output = "extrapolation";
  std::int64_t reach = 60;
  bool history = true;
  std::int64_t memory_layer = 1;
  std::int64_t decoder_layer = 2;
  std::int64_t decoder_head = 4;
  std::int64_t decoder_embd = 128;
  double shown_first = 0.25;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("architecture", architecture, {"flat", "frames"},
             "flat: one position a token (the thesis); frames: one position a frame, and a small "
             "decoder over the channels of each frame");
    v.choice("objective", objective, {"causal", "masked"},
             "causal: predict the next token; masked: fill in hidden tokens, seeing those on both "
             "sides (flat only)");
    v.integer("n_layer", n_layer, 1, 96, "transformer blocks");
    v.integer("n_head", n_head, 1, 128, "attention heads; divides n_embd");
    v.integer("n_embd", n_embd, 8, 8192, "width of the embedding");
    v.integer("block_size", block_size, 16, 65536,
              "positions in the context window: tokens (flat) or frames (frames)");
    v.number("dropout", dropout, 0, 0.9, "embedding, attention and residual dropout");
    v.choice(
        "position", position, {"custom", "absolute"},
        "custom: embeddings of frame and joint channel (thesis 4.5.2); absolute: of the position");
    v.choice(
        "output", output, {"extrapolation", "absolute"},
        "absolute: logits over bins (the thesis); extrapolation: adds logits over the distance to "
        "the linear extrapolation 2x[t-1]-x[t-2] of the same channel (masked: to the line between "
        "the nearest known frames)");
    v.integer("reach", reach, 1, 4096,
              "bins on each side of the extrapolation with a logit of their own");
    v.boolean("history", history, "embed each channel's own recent movement beside the tokens");
    v.integer("memory_layer", memory_layer, 0, 32,
              "frames: blocks that read each joint's own past, alike for all joints");
    v.integer("decoder_layer", decoder_layer, 1, 32, "frames: blocks of the joint decoder");
    v.integer("decoder_head", decoder_head, 1, 64,
              "frames: attention heads of the joint decoder; divides decoder_embd");
    v.integer("decoder_embd", decoder_embd, 8, 2048, "frames: width of the joint decoder");
    v.number("shown_first", shown_first, 0, 1,
             "frames: share of the training in which random joints of a frame come before the "
             "others, as prompted joints do");
  }
};

// The token stream's side of a model; fixed by the tokenizer it was trained with.
struct StreamShape {
  std::int64_t vocabulary = 0;  // ids, label values included
  std::int64_t first_bin = 0;   // id of bin 0
  std::int64_t bins = 0;
  std::int64_t channels = 0;  // a frame has channels + 1 characters, the last is the separator
  // Tokens of several characters of a frame (tokenizer/piece_vocabulary.h), whose ids follow the
  // bins'; and the characters of the longest.
  std::int64_t pieces = 0, longest = 1;

  // Characters, which are tokens of their own where there are no pieces.
  std::int64_t tokens_per_frame() const { return channels + 1; }
  std::int64_t fewest_tokens_per_frame() const { return (channels + longest) / longest; }
};

struct ModelDescription {
  ModelConfig config;
  StreamShape shape;
  std::string tokenizer_fingerprint;
  std::string pieces_fingerprint;       // empty: no pieces
  std::vector<std::string> conditions;  // labels whose tokens head each window, in this order
  std::vector<std::pair<std::string, std::vector<std::string>>>
      classes;                     // classified labels, values
  std::int64_t class_frames = 0;   // of a window that is classified; 0: not yet known
  bool procedural = false;         // trained on procedural dances only
  Json training = Json::object();  // the resolved settings of the run that made it, for the record

  bool frame_positions() const { return config.architecture == "frames"; }
  // Each position predicts its own token and sees the whole window (model/masked_input.h).
  bool masked() const { return config.objective == "masked"; }
  bool has_pieces() const { return shape.pieces > 0; }
  // Tokens of a frame that have a loss: of a masked model all but the separator. With pieces a
  // frame has that many or fewer.
  std::int64_t predicted_per_frame() const {
    return masked() ? shape.channels : shape.tokens_per_frame();
  }
  // Positions before the first frame: start and conditions.
  std::int64_t prefix() const { return 1 + static_cast<std::int64_t>(conditions.size()); }
};

// Throws UsageError when settings contradict each other (n_head does not divide n_embd, a block
// that does not hold the conditions and one whole frame).
void check_model(const ModelDescription& description);

Json to_json(const ModelDescription& description);
// Throws DataError on missing, unknown or impossible keys.
ModelDescription model_from_json(const Json& json, const std::string& place);

// Whole frames that a window holds beside its prefix, when `reserve` positions stay free; with
// pieces it may hold more.
std::int64_t frames_in_window(const ModelDescription& description, std::int64_t reserve = 0);
// Tokens of such a window, prefix included: "flat" also has the beginning of one more frame.
std::int64_t tokens_in_window(const ModelDescription& description, std::int64_t reserve = 0);

// "frames": channels that are decided together, a joint's rotation or the root's translation.
constexpr std::int64_t kJointChannels = 3;
// "frames": width of the layer that decides a channel within its joint, over decoder_embd.
constexpr std::int64_t kFeedForward = 2;

// Shapes that both the trainable model and the decoding engine derive from a description.
struct ModelSizes {
  std::int64_t frame_positions;  // of a window: 0 for the prefix, then 1, 2, ...
  // Rows of the channel embedding: channels, separator, prefix; with pieces as many again for each
  // length of two or more characters.
  std::int64_t channel_positions;
  std::int64_t history_rows;  // rows of each history embedding: 0 for "none", then -reach..reach
  std::int64_t offsets;       // logits relative to the extrapolation: 2 * reach + 1
};
ModelSizes model_sizes(const ModelDescription& description);

// Weights of the whole model, without heads of classification. A double: a hostile config's count
// would overflow.
double parameter_count(const ModelDescription& description);

}  // namespace mocaplm
