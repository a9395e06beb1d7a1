// A tiny model with random weights on disk, and a dataset for it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "model/directory.h"
#include "support/small_dataset.h"
#include "support/small_models.h"
#include "tokenizer/tokenizer.h"
#include "train/stream_shape.h"

namespace mocaplm {

// A knee, an elbow and the root at 20 frames a second; knows the condition "style".
inline StoredModel small_dancer(const std::vector<std::string>& joints = {"left_knee",
                                                                          "right_elbow"}) {
  TokenizerConfig config;
  config.bins = 16;
  config.fps = 20;
  config.joints = joints;
  Tokenizer tokenizer = Tokenizer::fit(config, {random_clip(1, 100)});
  tokenizer.add_label_values("style", {"calm", "wild"});
  StoredModel model;
  model.description = small_description();
  model.description.config.block_size = 12 * tokenizer.tokens_per_frame();
  model.description.shape = stream_shape(tokenizer);
  model.description.tokenizer_fingerprint = tokenizer.fingerprint();
  model.description.conditions = {"style"};
  model.tensors = random_weights(model.description, 2);
  model.tokenizer = tokenizer.to_json();
  return model;
}

// Test clips of 6, 3 and 1 s, one with a style that the model does not know.
inline void write_small_dataset(const std::filesystem::path& folder) {
  write_dataset(folder, {{"a", "test", 360, {{"style", "calm"}}, 60},
                         {"b", "test", 92, {{"style", "odd"}}, 30},
                         {"c", "test", 30, {}, 30},
                         {"d", "train", 60, {}, 60}});
}

}  // namespace mocaplm
