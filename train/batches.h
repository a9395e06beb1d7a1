// The batches of a step and what one does with them.
#pragma once

#include <vector>

#include "model/transformer/language_model.h"
#include "train/config.h"
#include "train/corpus.h"

namespace mocaplm {

// The seed of everything random in one step: a resumed run needs no other state.
std::uint64_t step_seed(std::int64_t seed, std::int64_t step);

struct MicroBatches {
  std::vector<Batch> batches;
  std::int64_t targets = 0;  // tokens that count in the loss, all micro-batches together
};

Batch stack_windows(const std::vector<Window>& windows);
// The windows of one step, the same whenever they are asked for.
MicroBatches draw_batches(const WindowSampler& sampler, const TrainConfig& config,
                          std::int64_t step);

// Forward and backward in training mode, dropout drawn from `seed`; gradients are added up. Returns
// the mean cross-entropy in nats of the tokens that count.
double accumulate_gradient(LanguageModel& model, const MicroBatches& batches,
                           const at::Device& device, std::uint64_t seed);

}  // namespace mocaplm
