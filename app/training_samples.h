// Motions that a model makes while it is trained, to see what it has learnt: after validations it
// goes on with the first second of one validation clip, always the same with the same seed.
//   RUN/samples/clip.npz        the clip, as long as the samples
//   RUN/samples/step-400.npz    the sample after step 400
#pragma once

#include <chrono>
#include <filesystem>
#include <utility>
#include <vector>

#include "train/trainer.h"

namespace mocaplm {

constexpr double kSamplePrompt = 1;  // seconds of the clip that each sample begins with

class TrainingSamples {
 public:
  TrainingSamples(std::filesystem::path run, const SampleConfig& config, int threads);

  // Writes a sample and the run's page anew: at the first and the last validation, and at others as
  // long as all this has taken less than 1% of the time. Does nothing for masked models, which do
  // not go on with a motion. What goes wrong is said once and leaves the training alone.
  void look(const Validated& now);

 private:
  using Clock = std::chrono::steady_clock;
  bool due(const Validated& now) const;
  void sample(const Validated& now);

  std::filesystem::path run_;
  double seconds_;
  int threads_;
  Clip clip_;
  double spent_ = 0;  // seconds
  bool first_ = true;
  Clock::time_point start_ = Clock::now();
};

struct TrainingSampleFiles {
  std::filesystem::path clip;
  std::vector<std::pair<std::int64_t, std::filesystem::path>> samples;  // by step
};

// What is there of a run's samples; none without its clip.
TrainingSampleFiles training_samples(const std::filesystem::path& run);

}  // namespace mocaplm
