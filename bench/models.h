// The two models that benchmarks speak of, with random weights: A, the thesis's size (8 layers, 8
// heads, 512 wide, 26 million parameters), and B (4 layers, 4 heads, 128 wide, 1 million); context
// 1,024, vocabulary 512, plain output, no history.
#pragma once

#include "common/random.h"
#include "model/directory.h"

namespace mocaplm {

inline ModelDescription bench_description(char name) {
  ModelDescription d;
  d.config.n_layer = name == 'A' ? 8 : 4;
  d.config.n_head = name == 'A' ? 8 : 4;
  d.config.n_embd = name == 'A' ? 512 : 128;
  d.config.block_size = 1024;
  d.config.position = "absolute";
  d.config.output = "absolute";
  d.config.history = false;
  d.shape = {512, 4, 360, 42};
  d.tokenizer_fingerprint = "none";
  return d;
}

inline StoredModel bench_model(char name) {
  StoredModel model;
  model.description = bench_description(name);
  Random random(1);
  const auto add = [&](const std::string& tensor, std::vector<std::int64_t> shape) {
    std::int64_t count = 1;
    for (const std::int64_t size : shape) count *= size;
    std::vector<float> values;
    for (std::int64_t i = 0; i < count; ++i)
      values.push_back(static_cast<float>(0.02 * random.normal()));
    model.tensors[tensor] = {std::move(shape), std::move(values)};
  };
  const std::int64_t width = model.description.config.n_embd;
  const auto linear = [&](const std::string& at, std::int64_t out, std::int64_t in) {
    add(at + ".weight", {out, in});
    add(at + ".bias", {out});
  };
  const auto norm = [&](const std::string& at) {
    add(at + ".weight", {width});
    for (float& value : model.tensors[at + ".weight"].values) value += 1;
    add(at + ".bias", {width});
  };
  add("token_embedding", {model.description.shape.vocabulary, width});
  add("position_embedding", {model.description.config.block_size, width});
  for (std::int64_t i = 0; i < model.description.config.n_layer; ++i) {
    const std::string at = "block." + std::to_string(i) + ".";
    norm(at + "ln1");
    linear(at + "qkv", 3 * width, width);
    linear(at + "proj", width, width);
    norm(at + "ln2");
    linear(at + "up", 4 * width, width);
    linear(at + "down", width, 4 * width);
  }
  norm("ln");
  linear("head", model.description.shape.vocabulary, width);
  return model;
}

// `count` positions of random bins.
inline ModelInput bench_input(const ModelDescription& model, std::int64_t count) {
  Random random(2);
  ModelInput input;
  for (std::int64_t i = 0; i < count; ++i) {
    input.token.push_back(static_cast<std::int32_t>(
        model.shape.first_bin +
        static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(model.shape.bins)))));
    for (auto list : {&ModelInput::frame, &ModelInput::channel, &ModelInput::surprise,
                      &ModelInput::velocity, &ModelInput::last_surprise})
      (input.*list).push_back(0);
    input.centre.push_back(kNoCentre);
  }
  return input;
}

}  // namespace mocaplm
