// AdamW with decay on the matrices only, the learning-rate schedule, and clipping.
#pragma once

#include <filesystem>
#include <memory>

#include "model/transformer/torch.h"
#include "train/config.h"

namespace torch::optim {
class AdamW;
}

namespace mocaplm {

// Linear warm-up to `learning_rate`, then a cosine down to final_learning_rate * learning_rate.
// `progress` is the share of the run that is done, in [0, 1].
double scheduled_rate(const TrainConfig& config, std::int64_t step, double progress);

class Optimizer {
 public:
  Optimizer(const torch::nn::Module& module, const TrainConfig& config);
  ~Optimizer();

  void zero_grad();
  // Clips the gradient to config.grad_clip and steps; parameters without a gradient stay. The
  // gradients themselves may be left as they were. Returns
  // the norm before clipping. On the CPU in one pass of its own, elsewhere LibTorch's.
  double step(double learning_rate);

  void save(const std::filesystem::path& path) const;
  // Throws DataError when the file is damaged or belongs to another model.
  void load(const std::filesystem::path& path);

 private:
  std::unique_ptr<torch::optim::AdamW> adamw_;
  std::vector<at::Tensor> parameters_;
  double grad_clip_;
};

}  // namespace mocaplm
