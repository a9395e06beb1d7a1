// Trainable models with random weights, whatever their architecture, and what they answer.
#pragma once

#include <cstdint>
#include <memory>

#include "model/transformer/language_model.h"
#include "model/transformer/weights.h"
#include "support/small_models.h"

namespace mocaplm {

// The same weights as random_weights(d, seed); not in training.
inline std::shared_ptr<LanguageModel> random_model(const ModelDescription& d, std::uint64_t seed) {
  const std::shared_ptr<LanguageModel> model = make_language_model(d);
  import_weights(*model, random_weights(d, seed), "made up");
  model->eval();
  return model;
}

inline at::Tensor logits_of(LanguageModel& model, const Batch& batch) {
  const at::NoGradGuard no_grad;
  return model.logits(model.hidden(batch), batch);
}

}  // namespace mocaplm
