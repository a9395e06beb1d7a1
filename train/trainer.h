// The training loop: batches made ahead, accumulation, validation, checkpoints, resume.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "model/transformer/weights.h"
#include "train/corpus.h"
#include "train/optimizer.h"

namespace mocaplm {

// What a run tells whoever looks on, after each validation.
struct Validated {
  std::int64_t step = 0;
  double bits_per_frame = 0;
  bool last = false;  // of the run
  const Dataset& dataset;
  std::function<StoredModel()> model;  // as it is now, without a self-test; copied when asked for
};

struct TrainOptions {
  RunConfig config;
  std::filesystem::path data, out;
  std::optional<std::filesystem::path> from;  // fine-tune this model
  bool resume = false;
  std::string device = "auto";
  int threads = 0;
  // The mocaplm that learns pieces (train/learn_pieces.h); empty: the one beside this program.
  std::filesystem::path tokenize_program;
  std::int64_t stop_after_step = 0;  // stop there as if interrupted, with last/ saved; 0: never
  std::function<void(const Validated&)> on_validation;  // may be null; its time is the run's
};

struct TrainResult {
  std::filesystem::path model;  // the best model's directory
  std::int64_t steps = 0;
  double best_bits_per_frame = 0;  // validation
  double tokens_per_second = 0;
  double seconds = 0;
  double seconds_waiting = 0;  // for batches, which are made while the step before runs
  std::int64_t parameters = 0;
};

// Trains and writes OUT/: settings.json, log.jsonl, last/ (resumable), best/ (lowest validation
// loss). Throws UsageError / DataError before any work when something does not fit together, and
// DataError when the loss stops being finite (last/ stays as it was).
TrainResult train(const TrainOptions& options);

// Thesis: mean cross-entropy in nats of a predicted token times such tokens of a frame, in bits.
double bits_per_frame(double nats_per_token, const ModelDescription& model);
double bits_per_frame(double nats_per_token, double predicted_per_frame);

}  // namespace mocaplm
