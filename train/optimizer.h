// AdamW with decay on the matrices only, the learning-rate schedule, and clipping.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "model/transformer/torch.h"
#include "train/adamw.h"
#include "train/config.h"

namespace mocaplm {

// Linear warm-up to `learning_rate`, then a cosine down to final_learning_rate * learning_rate.
// `progress` is the share of the run that is done, in [0, 1].
double scheduled_rate(const TrainConfig& config, std::int64_t step, double progress);

class Optimizer {
 public:
  Optimizer(const torch::nn::Module& module, const TrainConfig& config);

  void zero_grad();
  // Clips the gradient to config.grad_clip and steps; parameters without a gradient stay, and so
  // does everything when the norm is not finite. Returns the norm before clipping.
  double step(double learning_rate);

  // A safetensors file: first.NAME, second.NAME (the moving averages) and steps.NAME for each
  // parameter that ever had a gradient.
  void save(const std::filesystem::path& path) const;
  // Throws DataError when the file is damaged or belongs to another model; then nothing changes.
  void load(const std::filesystem::path& path);

 private:
  std::vector<at::Tensor> parameters_;
  std::vector<std::string> names_;
  std::vector<double> decays_;
  std::vector<AdamWState> states_;
  AdamWRates rates_;
  double grad_clip_;
};

}  // namespace mocaplm
