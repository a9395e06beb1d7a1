// The settings of a training run; a config file has the sections "tokenizer", "pieces", "model" and
// "train".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/settings.h"
#include "model/config.h"
#include "tokenizer/pieces.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

struct TrainConfig {
  std::int64_t steps = 2000;
  std::int64_t batch_size = 16;
  std::int64_t micro_batch = 8;
  double learning_rate = 6e-4;
  double final_learning_rate = 0.05;
  std::int64_t warmup = 100;
  double weight_decay = 0.1;
  double beta2 = 0.95;
  double grad_clip = 1.0;
  bool mirror = false;
  bool heading = false;
  double speed = 1;
  double joint_subset = 0;
  std::string balance;
  double balance_share = 0.5;
  double mask_share = 0.15;
  double mask_spans = 0;
  std::vector<std::string> conditions;
  double condition_dropout = 0.1;
  std::int64_t validate_every = 250;
  std::int64_t validation_windows = 64;
  std::int64_t save_every = 500;
  double max_minutes = 0;
  std::int64_t seed = 1;
  std::string precision = "auto";

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("steps", steps, 1, 100000000, "optimiser steps");
    v.integer("batch_size", batch_size, 1, 65536, "windows per optimiser step");
    v.integer("micro_batch", micro_batch, 1, 65536,
              "windows computed at once; the rest of the batch is accumulated");
    v.number("learning_rate", learning_rate, 0, 1, "peak learning rate of AdamW");
    v.number("final_learning_rate", final_learning_rate, 0, 1,
             "share of the peak left at the end of the cosine decay");
    v.integer("warmup", warmup, 0, 1000000, "steps of linear warm-up");
    v.number("weight_decay", weight_decay, 0, 10,
             "decay of the matrices (not of embeddings, biases, norms)");
    v.number("beta2", beta2, 0.5, 0.99999, "AdamW's second decay rate");
    v.number("grad_clip", grad_clip, 0, 1000, "largest norm of the gradient, 0 for none");
    v.boolean("mirror", mirror, "also train on the left-right mirrored motion (appendix A.5)");
    v.boolean("heading", heading,
              "turn each clip by a random angle about the vertical, another in every epoch (5.1)");
    v.number("speed", speed, 1, 4,
             "play each clip at a random speed between 1 / speed and speed, another in every epoch "
             "(5.1); 1 for its own");
    v.number("joint_subset", joint_subset, 0, 1,
             "share of windows that show some of the joints only (5.1)");
    v.text("balance", balance,
           "label whose rarer values are drawn more often than their clips are long; empty: none");
    v.number("balance_share", balance_share, 0, 1,
             "how much more often: 0 by their length, 1 all values alike");
    v.number("mask_share", mask_share, 0.01, 1, "masked: share of the tokens that are hidden");
    v.number("mask_spans", mask_spans, 0, 1,
             "masked: share of windows in which joints are hidden over a stretch of frames, as "
             "infilling meets them");
    v.texts(
        "conditions", conditions,
        "labels whose tokens head each window; with --from all labels of the data unless 'none'");
    v.number("condition_dropout", condition_dropout, 0, 1,
             "share of condition tokens hidden, so that each may be left open");
    v.integer("validate_every", validate_every, 1, 100000000, "steps between validations");
    v.integer("validation_windows", validation_windows, 1, 100000,
              "windows of the validation split looked at");
    v.integer("save_every", save_every, 1, 100000000, "steps between checkpoints");
    v.number("max_minutes", max_minutes, 0, 100000,
             "stop after this time, the learning rate decaying to fit; 0 for no limit (only then a "
             "run repeats exactly)");
    v.integer("seed", seed, 0, 2147483647, "seed of weights, windows and dropout");
    v.choice("precision", precision, {"auto", "bf16", "f32"},
             "type of the matrix products; auto: bf16 where the machine has it");
  }
};

// Of train --range-test.
struct RangeTestConfig {
  std::int64_t range_steps = 100;
  double range_low = 1e-6;
  double range_high = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("range_steps", range_steps, 10, 100000, "steps from the lowest rate to the highest");
    v.number("range_low", range_low, 1e-12, 1, "lowest learning rate");
    v.number("range_high", range_high, 1e-12, 100, "highest learning rate");
  }
};

// Of the motions that train makes on its way, for the page of the run.
struct SampleConfig {
  double sample_seconds = 4;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("sample_seconds", sample_seconds, 0, 60,
             "after validations, let the model go on with a validation clip for so long, and show "
             "it on the page of the run; the first and the last, others while all take under 1% of "
             "the time; 0: never");
  }
};

struct RunConfig {
  TokenizerConfig tokenizer;
  PieceConfig pieces;  // flat: tokens of several characters, learnt on the training split
  ModelConfig model;
  TrainConfig train;
};

// Strict: unknown sections and keys are errors. Throws DataError.
RunConfig load_run_config(const std::filesystem::path& path);
RunConfig run_config_from_json(const Json& json, const std::string& place);
Json to_json(const RunConfig& config);

}  // namespace mocaplm
