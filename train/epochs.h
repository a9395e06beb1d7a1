// The training corpus of each step. Where clips are augmented, the first epoch has them as they
// were recorded, and each later one has them changed anew; the next epoch's corpus is encoded while
// the present one is trained on, so that nobody waits unless encoding takes longer than training.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <memory>

#include "train/corpus.h"

namespace mocaplm {

class Epochs {
 public:
  // Encodes the corpus of an epoch, 1 or later; may give up when the flag becomes true.
  using Encode = std::function<Corpus(std::int64_t epoch, const std::atomic<bool>& stop)>;

  // `first` and `model` must outlive this. `steps` of an epoch; without `encode` the first never
  // ends.
  Epochs(const Corpus& first, const ModelDescription& model, std::int64_t steps, Encode encode);
  ~Epochs();

  // The windows of a step, 0 or later; steps are asked for in ascending order, one at a time. Waits
  // where the epoch's corpus is not there yet. Throws what `encode` throws.
  const WindowSampler& at(std::int64_t step);
  std::int64_t epoch() const { return epoch_; }

 private:
  void start(std::int64_t epoch);

  const ModelDescription& model_;
  std::int64_t steps_, epoch_ = 0, coming_ = 0;  // coming_: epoch of next_
  Encode encode_;
  std::atomic<bool> stop_{false};
  std::future<Corpus> next_;
  std::unique_ptr<Corpus> own_;
  std::unique_ptr<WindowSampler> sampler_;
};

// Steps that draw about as many frames as the corpus has, 100 at least.
std::int64_t steps_of_an_epoch(std::int64_t frames, std::int64_t batch_size,
                               std::size_t window_frames);

}  // namespace mocaplm
