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

// The tensors that the file of such a model holds (docs: model.safetensors), with random values
// large enough that attention, history and both outputs all matter to the logits.
inline TensorMap random_weights(const ModelDescription& d, std::uint64_t seed) {
  Random random(seed);
  TensorMap tensors;
  const auto add = [&](const std::string& name, std::vector<std::int64_t> shape, double deviation,
                       double mean = 0) {
    NamedTensor tensor;
    tensor.shape = std::move(shape);
    for (std::int64_t i = 0; i < tensor.size(); ++i)
      tensor.values.push_back(static_cast<float>(mean + deviation * random.normal()));
    tensors[name] = tensor;
  };
  const auto linear = [&](const std::string& name, std::int64_t out, std::int64_t in) {
    add(name + ".weight", {out, in}, 0.3);
    add(name + ".bias", {out}, 0.1);
  };
  const auto norm = [&](const std::string& name, std::int64_t width) {
    add(name + ".weight", {width}, 0.2, 1);
    add(name + ".bias", {width}, 0.1);
  };
  const ModelConfig& c = d.config;
  const std::int64_t width = c.n_embd;
  add("token_embedding", {d.shape.vocabulary, width}, 0.5);
  if (c.position == "custom") {
    add("frame_embedding", {c.block_size / (d.shape.channels + 1) + 3, width}, 0.5);
    add("channel_embedding", {d.shape.channels + 2, width}, 0.5);
  } else {
    add("position_embedding", {c.block_size, width}, 0.5);
  }
  if (c.history)
    for (const char* name : {"history.surprise", "history.velocity", "history.last_surprise"})
      add(name, {2 * c.reach + 2, width}, 0.5);
  for (std::int64_t i = 0; i < c.n_layer; ++i) {
    const std::string at = "block." + std::to_string(i) + ".";
    norm(at + "ln1", width);
    linear(at + "qkv", 3 * width, width);
    linear(at + "proj", width, width);
    norm(at + "ln2", width);
    linear(at + "up", 4 * width, width);
    linear(at + "down", width, 4 * width);
  }
  norm("ln", width);
  linear("head", d.shape.vocabulary, width);
  if (c.output == "extrapolation") linear("offset_head", 2 * c.reach + 1, width);
  return tensors;
}

}  // namespace mocaplm
