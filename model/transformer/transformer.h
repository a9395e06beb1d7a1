// The trainable decoder-only transformer of thesis Figure 4.1, pre-norm as in minGPT: token
// embedding plus absolute positions or the custom frame + joint-channel embedding (4.5.2), causal
// attention, output layer.
#pragma once

#include <vector>

#include "model/config.h"
#include "model/input.h"
#include "model/safetensors.h"
#include "model/transformer/block.h"
#include "model/transformer/output.h"
#include "model/transformer/torch.h"

namespace mocaplm {

// A batch of ModelInputs; all (B, T) int64. `target` is the next id, -1 where the loss ignores it.
struct Batch {
  at::Tensor token, frame, channel, centre, surprise, velocity, last_surprise, target;

  Batch to(const at::Device& device) const;
};

// Stacks inputs of equal length; `targets` may be empty.
Batch stack(const std::vector<ModelInput>& inputs,
            const std::vector<std::vector<std::int32_t>>& targets = {});

class Transformer : public torch::nn::Module {
 public:
  // Fresh weights: normal with deviation 0.02, residual projections scaled by 1 / sqrt(2 n_layer).
  explicit Transformer(const ModelDescription& description);

  // The type of the matrix products: f32 or bf16 (weights stay f32).
  void set_precision(at::ScalarType type) { precision_ = type; }
  at::ScalarType precision() const { return precision_; }

  // Final normalised states (B, T + F, C) in f32. `extra` (B, F, C), if defined, is appended to the
  // embedded batch: F classification tokens that attend to the whole window (Figure 4.13).
  at::Tensor hidden(const Batch& batch, const at::Tensor& extra = {});
  // (B, T, V) from hidden states (B, T, C) of the batch's own positions.
  at::Tensor logits(const at::Tensor& hidden, const Batch& batch);
  // Cross-entropy in nats of each position (B, T).
  at::Tensor loss(const at::Tensor& hidden, const Batch& batch);

  const ModelDescription& description() const { return description_; }

 private:
  at::Tensor embed(const Batch& batch) const;
  at::Tensor drop(const at::Tensor& x) const;
  at::Tensor make(const std::string& name, at::IntArrayRef shape, double deviation,
                  double mean = 0);
  LinearWeights make_linear(const std::string& name, std::int64_t out, std::int64_t in,
                            double deviation);
  std::pair<at::Tensor, at::Tensor> heads(const at::Tensor& flat) const;

  ModelDescription description_;
  at::ScalarType precision_ = at::kFloat;
  at::Tensor token_, frame_, channel_, position_, surprise_, velocity_, last_surprise_;
  std::vector<BlockWeights> blocks_;
  at::Tensor ln_w_, ln_b_;
  LinearWeights head_, offset_head_;
};

}  // namespace mocaplm
