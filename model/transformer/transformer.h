// The thesis's decoder-only transformer (Figure 4.1), pre-norm as in minGPT: one position a token;
// token embedding plus absolute positions or the custom frame + joint-channel embedding (4.5.2),
// causal attention (with "objective" masked every position sees the whole window), output layer.
#pragma once

#include "model/transformer/language_model.h"

namespace mocaplm {

class Transformer : public LanguageModel {
 public:
  explicit Transformer(const ModelDescription& description);

  at::Tensor hidden(const Batch& batch, const at::Tensor& extra = {}) override;
  at::Tensor logits(const at::Tensor& hidden, const Batch& batch) override;
  at::Tensor loss(const at::Tensor& hidden, const Batch& batch) override;

 private:
  at::Tensor embed(const Batch& batch) const;

  at::Tensor token_, frame_, channel_, position_, surprise_, velocity_, last_surprise_;
  std::vector<BlockWeights> blocks_;
  at::Tensor ln_w_, ln_b_;
};

}  // namespace mocaplm
