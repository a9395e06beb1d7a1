#include "train/epochs.h"

#include <algorithm>

namespace mocaplm {

namespace {

constexpr std::int64_t kFewestSteps = 100;

}  // namespace

Epochs::Epochs(const Corpus& first, const ModelDescription& model, std::int64_t steps,
               Encode encode)
    : model_(model),
      steps_(steps),
      encode_(std::move(encode)),
      sampler_(std::make_unique<WindowSampler>(first, model)) {}

Epochs::~Epochs() {
  stop_ = true;  // the future waits for its end
}

void Epochs::start(std::int64_t epoch) {
  coming_ = epoch;
  next_ = std::async(std::launch::async, [this, epoch] { return encode_(epoch, stop_); });
}

const WindowSampler& Epochs::at(std::int64_t step) {
  if (!encode_) return *sampler_;
  const std::int64_t wanted = step / steps_;
  if (wanted != epoch_) {
    if (!next_.valid() || coming_ != wanted) start(wanted);  // a run that is gone on with
    auto corpus = std::make_unique<Corpus>(next_.get());
    sampler_ = std::make_unique<WindowSampler>(*corpus, model_);
    own_ = std::move(corpus);
    epoch_ = wanted;
  }
  if (!next_.valid()) start(epoch_ + 1);
  return *sampler_;
}

std::int64_t steps_of_an_epoch(std::int64_t frames, std::int64_t batch_size,
                               std::size_t window_frames) {
  const std::int64_t drawn = batch_size * static_cast<std::int64_t>(window_frames);
  return std::max(kFewestSteps, (frames + drawn - 1) / drawn);
}

}  // namespace mocaplm
