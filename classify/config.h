// Settings of the classifier's training (thesis 4.7: batch 16, language-model loss trained
// jointly).
#pragma once

#include <string>
#include <vector>

#include "common/settings.h"

namespace mocaplm {

struct ClassifyConfig {
  std::vector<std::string> labels;
  std::int64_t steps = 1000;
  std::int64_t batch_size = 16;
  double learning_rate = 0;
  double dropout = 0;
  double language_loss = 1;
  double short_windows = 0.7;
  std::int64_t short_frames = 0;
  std::int64_t window_frames = 0;
  bool mirror = false;
  std::int64_t validate_every = 100;
  double max_minutes = 0;
  double shrinkage = 0.1;
  std::int64_t seed = 1;
  std::string precision = "auto";

  template <class Visitor>
  void describe(Visitor& v) {
    v.texts("labels", labels,
            "labels to classify, comma separated (default: all with at least two values)");
    v.integer("steps", steps, 1, 10000000, "optimiser steps");
    v.integer("batch_size", batch_size, 1, 4096, "windows per step");
    v.number("learning_rate", learning_rate, 0, 1,
             "peak learning rate; 0 for the rate the model was pre-trained with, 2e-5 at least");
    v.number("dropout", dropout, 0, 0.9, "dropout while fine-tuning");
    v.number("language_loss", language_loss, 0, 100,
             "weight of the language-model loss trained jointly");
    v.number("short_windows", short_windows, 0, 1,
             "share of the training, its beginning, on windows of a few frames: several times as "
             "many steps in the same time");
    v.integer("short_frames", short_frames, 0, 100000,
              "frames of those windows; 0 for a fifth of a whole window");
    v.integer("window_frames", window_frames, 0, 100000,
              "frames of a whole window; 0 for the context's, or for \"frames\" as many as 1,024 "
              "tokens have");
    v.boolean("mirror", mirror,
              "also train on mirrored clips; left and right change places in their labels");
    v.integer("validate_every", validate_every, 1, 10000000,
              "steps between looks at the validation split");
    v.number("max_minutes", max_minutes, 0, 100000, "stop after this time; 0 for no limit");
    v.number("shrinkage", shrinkage, 0, 1,
             "LDA: share of the covariance replaced by a multiple of the identity");
    v.integer("seed", seed, 0, 2147483647, "seed of fresh weights, windows and dropout");
    v.choice("precision", precision, {"auto", "bf16", "f32"}, "type of the matrix products");
  }
};

}  // namespace mocaplm
