#include "train/optimizer.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "model/safetensors.h"

namespace mocaplm {

namespace {

const std::string kFirst = "first.", kSecond = "second.", kSteps = "steps.";

NamedTensor stored(const at::Tensor& tensor) {
  const at::Tensor values = tensor.detach().to(at::kCPU).to(at::kFloat).contiguous();
  const float* begin = values.data_ptr<float>();
  return {values.sizes().vec(), std::vector<float>(begin, begin + values.numel())};
}

// The moving average `name`, which must be of the parameter's shape.
at::Tensor restored(const TensorMap& file, const std::string& name, const at::Tensor& parameter,
                    const std::string& place) {
  const auto found = file.find(name);
  if (found == file.end() || found->second.shape != parameter.sizes().vec())
    throw DataError(in_file(place), "is the optimiser's state of another model: tensor \"" + name +
                                        "\" is missing or of another shape");
  return at::tensor(found->second.values, at::kFloat)
      .view(parameter.sizes())
      .to(parameter.device());
}

std::int64_t restored_steps(const NamedTensor& tensor, const std::string& name,
                            const std::string& place) {
  const float steps = tensor.values.size() == 1 ? tensor.values[0] : -1;
  if (!(steps >= 1) || steps != std::floor(steps))
    throw DataError(in_file(place), "tensor \"" + name + "\": expected a number of steps");
  return static_cast<std::int64_t>(steps);
}

}  // namespace

double scheduled_rate(const TrainConfig& config, std::int64_t step, double progress) {
  if (step < config.warmup)
    return config.learning_rate * static_cast<double>(step + 1) /
           static_cast<double>(config.warmup);
  const double floor = config.final_learning_rate * config.learning_rate;
  const double cosine = 0.5 * (1 + std::cos(kPi * std::clamp(progress, 0.0, 1.0)));
  return floor + (config.learning_rate - floor) * cosine;
}

Optimizer::Optimizer(const torch::nn::Module& module, const TrainConfig& config)
    : grad_clip_(config.grad_clip) {
  rates_.beta2 = config.beta2;
  for (const auto& item : module.named_parameters()) {
    const bool embedding = item.key().find("embedding") != std::string::npos ||
                           item.key().find("history") != std::string::npos;
    parameters_.push_back(item.value());
    names_.push_back(item.key());
    decays_.push_back(item.value().dim() == 2 && !embedding ? config.weight_decay : 0);
  }
  states_.resize(parameters_.size());
}

void Optimizer::zero_grad() {
  for (at::Tensor& parameter : parameters_) parameter.mutable_grad() = at::Tensor();
}

double Optimizer::step(double learning_rate) {
  const double norm = gradient_norm(parameters_);
  if (!std::isfinite(norm)) return norm;
  rates_.learning_rate = learning_rate;
  rates_.shrink = grad_clip_ > 0 ? std::min(1.0, grad_clip_ / (norm + 1e-6)) : 1;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (!parameters_[i].grad().defined()) continue;
    rates_.decay = decays_[i];
    adamw_step(parameters_[i], states_[i], rates_);
  }
  return norm;
}

void Optimizer::save(const std::filesystem::path& path) const {
  TensorMap file;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (states_[i].steps == 0) continue;
    file[kFirst + names_[i]] = stored(states_[i].first);
    file[kSecond + names_[i]] = stored(states_[i].second);
    // A whole number up to 16 million in f32; beyond, what it decides is long over.
    file[kSteps + names_[i]] = {{1}, {static_cast<float>(states_[i].steps)}};
  }
  write_safetensors(path, file);
}

void Optimizer::load(const std::filesystem::path& path) {
  const std::string place = path.string();
  const TensorMap file = read_safetensors(path);
  std::vector<AdamWState> states(parameters_.size());
  std::size_t taken = 0;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const auto steps = file.find(kSteps + names_[i]);
    if (steps == file.end()) continue;  // it never had a gradient
    states[i].steps = restored_steps(steps->second, steps->first, place);
    states[i].first = restored(file, kFirst + names_[i], parameters_[i], place);
    states[i].second = restored(file, kSecond + names_[i], parameters_[i], place);
    if ((states[i].second < 0).any().item<bool>())
      throw DataError(in_file(place),
                      "tensor \"" + kSecond + names_[i] +
                          "\" holds negative numbers, expected averages of squares");
    taken += 3;
  }
  if (taken != file.size())
    throw DataError(in_file(place),
                    "is the optimiser's state of another model: it holds tensors "
                    "that this one has not");
  states_ = std::move(states);
}

}  // namespace mocaplm
