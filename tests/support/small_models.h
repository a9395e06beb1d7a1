// Tiny models with random weights and random token streams; no LibTorch.
#pragma once

#include <string>
#include <vector>

#include "common/random.h"
#include "model/config.h"
#include "model/input.h"
#include "model/safetensors.h"

namespace mocaplm {

// 2 layers, 2 heads, width 16, 5 whole frames of 3 channels beside a prefix of up to 4 tokens.
inline ModelDescription small_description(const std::string& position = "custom",
                                          const std::string& output = "extrapolation",
                                          bool history = true) {
  ModelDescription d;
  d.config.n_layer = 2;
  d.config.n_head = 2;
  d.config.n_embd = 16;
  d.config.block_size = 24;
  d.config.dropout = 0;
  d.config.position = position;
  d.config.output = output;
  d.config.reach = 5;
  d.config.history = history;
  d.shape = {4 + 11 + 3, 4, 11, 3};
  d.tokenizer_fingerprint = "made up";
  return d;
}

// "frames": 2 and 2 layers, widths 16 and 8, up to 8 frames of 2 joints beside a prefix of 1.
inline ModelDescription small_frames_description(const std::string& output = "extrapolation",
                                                 bool history = true) {
  ModelDescription d = small_description("custom", output, history);
  d.config.architecture = "frames";
  d.config.block_size = 9;
  d.config.decoder_layer = 2;
  d.config.decoder_head = 2;
  d.config.decoder_embd = 8;
  d.shape.channels = 6;
  return d;
}

// Every combination of position, output and history.
inline std::vector<ModelDescription> all_variants() {
  std::vector<ModelDescription> all;
  for (const char* position : {"custom", "absolute"})
    for (const char* output : {"extrapolation", "absolute"})
      for (const bool history : {true, false})
        all.push_back(small_description(position, output, history));
  return all;
}

inline std::string variant_name(const ModelDescription& d) {
  return d.config.position + " positions, " + d.config.output + " output, " +
         (d.config.history ? "history" : "no history");
}

// Whole frames: each channel a random walk over the bins, the separator (id 3) after each frame.
inline std::vector<std::int32_t> random_stream(const StreamShape& shape, std::int64_t frames,
                                               Random& random) {
  std::vector<std::int64_t> bin;
  for (std::int64_t c = 0; c < shape.channels; ++c)
    bin.push_back(static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(shape.bins))));
  std::vector<std::int32_t> ids;
  for (std::int64_t t = 0; t < frames; ++t) {
    for (std::int64_t& b : bin) {
      b = std::min(std::max<std::int64_t>(b + static_cast<std::int64_t>(random.below(5)) - 2, 0),
                   shape.bins - 1);
      ids.push_back(static_cast<std::int32_t>(shape.first_bin + b));
    }
    ids.push_back(3);
  }
  return ids;
}

// Fills tensors with random values large enough that every part matters to the logits.
class RandomWeights {
 public:
  explicit RandomWeights(std::uint64_t seed) : random_(seed) {}

  void add(const std::string& name, std::vector<std::int64_t> shape, double deviation = 0.5,
           double mean = 0) {
    NamedTensor tensor;
    tensor.shape = std::move(shape);
    for (std::int64_t i = 0; i < tensor.size(); ++i)
      tensor.values.push_back(static_cast<float>(mean + deviation * random_.normal()));
    tensors_[name] = tensor;
  }
  void linear(const std::string& name, std::int64_t out, std::int64_t in, double deviation = 0.3) {
    add(name + ".weight", {out, in}, deviation);
    add(name + ".bias", {out}, 0.1);
  }
  void norm(const std::string& name, std::int64_t width) {
    add(name + ".weight", {width}, 0.2, 1);
    add(name + ".bias", {width}, 0.1);
  }
  void blocks(const std::string& name, std::int64_t layers, std::int64_t width) {
    for (std::int64_t i = 0; i < layers; ++i) {
      const std::string at = name + std::to_string(i) + ".";
      norm(at + "ln1", width);
      linear(at + "qkv", 3 * width, width);
      linear(at + "proj", width, width);
      norm(at + "ln2", width);
      linear(at + "up", 4 * width, width);
      linear(at + "down", width, 4 * width);
    }
  }
  TensorMap tensors() const { return tensors_; }

 private:
  Random random_;
  TensorMap tensors_;
};

inline void add_frames_weights(RandomWeights& w, const ModelDescription& d) {
  const ModelConfig& c = d.config;
  const std::int64_t channels = d.shape.channels, features = channels * kFrameFeatures,
                     joints = channels / 3, narrow = c.decoder_embd, rows = 2 * c.reach + 2;
  w.add("position_embedding", {c.block_size, c.n_embd});
  w.linear("frame_in", c.n_embd, features, 0.1);
  w.linear("joint_in", joints * narrow, c.n_embd + features, 0.1);
  w.linear("joint.own_in", narrow, 3 * kFrameFeatures, 0.2);
  w.add("joint.embedding", {joints, narrow});
  w.add("joint.before_embedding", {joints + 1, narrow});
  w.add("joint.chosen_embedding", {1 + 3 * d.shape.bins, narrow});
  w.add("joint.time_embedding", {c.block_size, narrow});
  w.blocks("joint.memory.", c.memory_layer, narrow);
  w.blocks("joint.decoder.", c.decoder_layer, narrow);
  w.linear("channel.in", 3 * narrow, narrow);
  w.linear("channel.own_in", narrow, kFrameFeatures);
  w.add("channel.embedding", {channels, narrow});
  w.add("channel.chosen_embedding", {1 + 2 * d.shape.bins, narrow});
  w.norm("channel.ln1", narrow);
  w.linear("channel.up", 2 * narrow, narrow);
  w.linear("channel.down", narrow, 2 * narrow);
  w.norm("channel.ln2", narrow);
  if (!c.history) return;
  w.add("joint.surprise_embedding", {1 + 3 * rows, narrow});
  w.add("channel.surprise_embedding", {1 + 2 * rows, narrow});
  w.add("channel.velocity_embedding", {rows, narrow});
  w.add("channel.last_surprise_embedding", {rows, narrow});
}

inline void add_flat_weights(RandomWeights& w, const ModelDescription& d) {
  const ModelConfig& c = d.config;
  if (c.position == "custom") {
    const std::int64_t fewest = (d.shape.channels + d.shape.longest) / d.shape.longest;
    w.add("frame_embedding", {c.block_size / fewest + 3, c.n_embd});
    w.add("channel_embedding", {(d.shape.channels + 2) * d.shape.longest, c.n_embd});
  } else {
    w.add("position_embedding", {c.block_size, c.n_embd});
  }
  if (c.history)
    for (const char* name : {"history.surprise", "history.velocity", "history.last_surprise"})
      w.add(name, {2 * c.reach + 2, c.n_embd});
}

// The tensors that the file of such a model holds (docs: model.safetensors), with random values.
inline TensorMap random_weights(const ModelDescription& d, std::uint64_t seed) {
  RandomWeights w(seed);
  const ModelConfig& c = d.config;
  const std::int64_t width = d.frame_positions() ? c.decoder_embd : c.n_embd;
  w.add("token_embedding", {d.shape.vocabulary, c.n_embd});
  d.frame_positions() ? add_frames_weights(w, d) : add_flat_weights(w, d);
  w.blocks("block.", c.n_layer, c.n_embd);
  w.norm("ln", c.n_embd);
  w.linear("head", d.shape.vocabulary, width);
  if (c.output == "extrapolation") w.linear("offset_head", 2 * c.reach + 1, width);
  return w.tensors();
}

}  // namespace mocaplm
