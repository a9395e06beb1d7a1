#include "train/optimizer.h"

#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adamw.h>
#include <torch/serialize.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/error.h"
#include "common/files.h"

namespace mocaplm {

namespace {

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

}  // namespace

double scheduled_rate(const TrainConfig& config, std::int64_t step, double progress) {
  constexpr double kPi = 3.14159265358979323846;
  if (step < config.warmup)
    return config.learning_rate * static_cast<double>(step + 1) /
           static_cast<double>(config.warmup);
  const double floor = config.final_learning_rate * config.learning_rate;
  const double cosine = 0.5 * (1 + std::cos(kPi * std::clamp(progress, 0.0, 1.0)));
  return floor + (config.learning_rate - floor) * cosine;
}

Optimizer::Optimizer(const torch::nn::Module& module, const TrainConfig& config)
    : grad_clip_(config.grad_clip) {
  std::vector<at::Tensor> matrices, others;
  for (const auto& item : module.named_parameters()) {
    parameters_.push_back(item.value());
    const bool embedding = item.key().find("embedding") != std::string::npos ||
                           item.key().find("history") != std::string::npos;
    (item.value().dim() == 2 && !embedding ? matrices : others).push_back(item.value());
  }
  const auto options = [&](double decay) {
    auto adamw = std::make_unique<torch::optim::AdamWOptions>(config.learning_rate);
    adamw->betas(std::make_tuple(0.9, config.beta2)).weight_decay(decay);
    return adamw;
  };
  std::vector<torch::optim::OptimizerParamGroup> groups;
  groups.emplace_back(matrices, options(config.weight_decay));
  groups.emplace_back(others, options(0));
  adamw_ = std::make_unique<torch::optim::AdamW>(std::move(groups), *options(config.weight_decay));
}

Optimizer::~Optimizer() = default;

void Optimizer::zero_grad() {
  adamw_->zero_grad();
}

double Optimizer::step(double learning_rate) {
  const double limit = grad_clip_ > 0 ? grad_clip_ : std::numeric_limits<double>::infinity();
  const double norm = torch::nn::utils::clip_grad_norm_(parameters_, limit);
  for (auto& group : adamw_->param_groups())
    static_cast<torch::optim::AdamWOptions&>(group.options()).lr(learning_rate);
  if (std::isfinite(norm)) adamw_->step();
  return norm;
}

void Optimizer::save(const std::filesystem::path& path) const {
  write_file_with(path, [&](const std::filesystem::path& temporary) {
    try {
      torch::save(*adamw_, temporary.string());
    } catch (const c10::Error& error) {
      throw DataError(in_file(path.string()), "cannot be written: " + first_line(error.what()));
    }
  });
}

void Optimizer::load(const std::filesystem::path& path) {
  try {
    torch::load(*adamw_, path.string());
  } catch (const std::exception& error) {  // LibTorch raises more than c10::Error here
    throw DataError(in_file(path.string()),
                    "is not a sound state of the optimiser: " + first_line(error.what()));
  }
  // LibTorch does not look at the shapes.
  std::multiset<std::vector<std::int64_t>> shapes;
  for (const at::Tensor& parameter : parameters_) shapes.insert(parameter.sizes().vec());
  for (const auto& item : adamw_->state()) {
    const auto& state = static_cast<const torch::optim::AdamWParamState&>(*item.second);
    const at::Tensor first = state.exp_avg(), second = state.exp_avg_sq();
    const auto shape = first.defined() ? shapes.find(first.sizes().vec()) : shapes.end();
    if (shape == shapes.end() || !second.defined() || second.sizes() != first.sizes() ||
        first.scalar_type() != at::kFloat || second.scalar_type() != at::kFloat)
      throw DataError(in_file(path.string()), "is the optimiser's state of another model");
    if (!at::isfinite(first).all().item<bool>() || !at::isfinite(second).all().item<bool>())
      throw DataError(in_file(path.string()), "holds values that are not finite");
    shapes.erase(shape);
  }
}

}  // namespace mocaplm
