// What every trainable model of motion can do, whatever its architecture.
#pragma once

#include <memory>
#include <vector>

#include "model/config.h"
#include "model/input.h"
#include "model/transformer/block.h"
#include "model/transformer/feed_forward.h"
#include "model/transformer/output.h"
#include "model/transformer/torch.h"

namespace mocaplm {

// A batch of ModelInputs; all (B, T) int64. `target` is the next id, -1 where the loss ignores it.
struct Batch {
  at::Tensor token, frame, channel, centre, surprise, velocity, last_surprise, target;
  std::int64_t prefix = 1;  // positions before the first frame, in every window of the batch

  Batch to(const at::Device& device) const;
};

// Stacks inputs of equal length; `targets` may be empty.
Batch stack(const std::vector<ModelInput>& inputs,
            const std::vector<std::vector<std::int32_t>>& targets = {});

class LanguageModel : public torch::nn::Module {
 public:
  // The type of the matrix products: f32 or bf16 (weights stay f32).
  void set_precision(at::ScalarType type) { precision_ = type; }
  at::ScalarType precision() const { return precision_; }
  const ModelDescription& description() const { return description_; }

  // Final normalised states (B, S + F, C) in f32; S = T ("flat"), or prefix + whole frames
  // ("frames"). `extra` (B, F, C), if defined, is appended to the embedded batch: F classification
  // tokens that attend to the whole window (Figure 4.13).
  virtual at::Tensor hidden(const Batch& batch, const at::Tensor& extra = {}) = 0;
  // (B, T, V) from the states (B, S, C) of the batch's own positions.
  virtual at::Tensor logits(const at::Tensor& hidden, const Batch& batch) = 0;
  // Cross-entropy in nats of each position (B, T); 0 where there is no target.
  virtual at::Tensor loss(const at::Tensor& hidden, const Batch& batch) = 0;

 protected:
  explicit LanguageModel(const ModelDescription& description);

  // Fresh weights are normal with deviation 0.02, residual projections scaled by
  // 1 / sqrt(2 layers), as in GPT-2.
  static constexpr double kDeviation = 0.02;
  at::Tensor make(const std::string& name, at::IntArrayRef shape, double deviation,
                  double mean = 0);
  at::Tensor make_table(const std::string& name, std::int64_t rows, std::int64_t width) {
    return make(name, {rows, width}, kDeviation);
  }
  LinearWeights make_linear(const std::string& name, std::int64_t out, std::int64_t in,
                            double deviation = kDeviation);
  // prefix0. , prefix1. , ...
  std::vector<BlockWeights> make_blocks(const std::string& prefix, std::int64_t layers,
                                        std::int64_t width);
  FeedForwardWeights make_feed_forward(const std::string& prefix, std::int64_t width,
                                       std::int64_t wide);
  at::Tensor drop(const at::Tensor& x) const;
  at::Tensor run_blocks(const std::vector<BlockWeights>& blocks, at::Tensor x, std::int64_t heads,
                        std::int64_t free) const;
  // The output layer on normalised states x (N, width): logits (N, V), cross-entropy (N).
  void make_output(std::int64_t width);
  at::Tensor output_logits(const at::Tensor& x, const at::Tensor& centre) const;
  at::Tensor output_loss(const at::Tensor& x, const at::Tensor& centre,
                         const at::Tensor& target) const;

  ModelDescription description_;
  at::ScalarType precision_ = at::kFloat;

 private:
  std::pair<at::Tensor, at::Tensor> heads(const at::Tensor& x) const;
  BinRange bins() const { return {description_.shape.first_bin, description_.shape.bins}; }

  LinearWeights head_, offset_head_;
};

// The model that description.config.architecture names, with fresh weights.
std::shared_ptr<LanguageModel> make_language_model(const ModelDescription& description);

}  // namespace mocaplm
