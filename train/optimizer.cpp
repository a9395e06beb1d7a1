#include "train/optimizer.h"

#include <ATen/Parallel.h>
#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adamw.h>
#include <torch/serialize.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <sstream>

#include "common/error.h"
#include "common/files.h"

namespace mocaplm {

namespace {

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

// CPU, f32, one piece: what the fused step can read as plain arrays.
bool is_plain(const at::Tensor& parameter, const at::Tensor& grad) {
  return parameter.device().is_cpu() && parameter.scalar_type() == at::kFloat &&
         parameter.is_contiguous() && grad.scalar_type() == at::kFloat && grad.is_contiguous() &&
         !grad.is_sparse();
}

// Piece by piece in a fixed order, so that the sum does not depend on the threads.
double sum_of_squares(const at::Tensor& grad) {
  constexpr std::int64_t kPiece = 1 << 15;
  const std::int64_t count = grad.numel(), pieces = (count + kPiece - 1) / kPiece;
  const float* g = grad.data_ptr<float>();
  std::vector<double> sums(static_cast<std::size_t>(pieces));
  at::parallel_for(0, pieces, 4, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t piece = first; piece < last; ++piece) {
      constexpr std::int64_t kLanes = 8;  // sums side by side, which the compiler makes vectors of
      double lanes[kLanes] = {};
      const std::int64_t end = std::min((piece + 1) * kPiece, count);
      std::int64_t i = piece * kPiece;
      for (; i + kLanes <= end; i += kLanes)
        for (std::int64_t lane = 0; lane < kLanes; ++lane) {
          const double value = g[i + lane];
          lanes[lane] += value * value;
        }
      for (; i < end; ++i) lanes[0] += static_cast<double>(g[i]) * g[i];
      sums[static_cast<std::size_t>(piece)] = std::accumulate(lanes, lanes + kLanes, 0.0);
    }
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

// LibTorch's state of a parameter, made where there is none. In older releases its key is a text.
template <class AdamW>
torch::optim::AdamWParamState& state_of(AdamW& adamw, const at::Tensor& parameter) {
  using Key = typename std::decay_t<decltype(adamw.state())>::key_type;
  std::unique_ptr<torch::optim::OptimizerParamState>* slot = nullptr;
  if constexpr (std::is_same_v<Key, std::string>) {
    std::ostringstream key;
    key << parameter.unsafeGetTensorImpl();
    slot = &adamw.state()[key.str()];
  } else {
    slot = &adamw.state()[parameter.unsafeGetTensorImpl()];
  }
  if (*slot == nullptr) {
    auto fresh = std::make_unique<torch::optim::AdamWParamState>();
    fresh->step(0);
    fresh->exp_avg(at::zeros_like(parameter, at::MemoryFormat::Contiguous));
    fresh->exp_avg_sq(at::zeros_like(parameter, at::MemoryFormat::Contiguous));
    *slot = std::move(fresh);
  }
  return static_cast<torch::optim::AdamWParamState&>(**slot);
}

// Loshchilov and Hutter 2019, algorithm 2, with what is the same for all elements worked out
// before.
struct AdamWFactors {
  float keep1, keep2, decay, rate, spread, eps, shrink;
};
void adamw_elements(float* __restrict p, const float* __restrict g, float* __restrict m,
                    float* __restrict v, std::int64_t count, const AdamWFactors f) {
  for (std::int64_t i = 0; i < count; ++i) {
    const float slope = g[i] * f.shrink;
    m[i] = f.keep1 * m[i] + (1 - f.keep1) * slope;
    v[i] = f.keep2 * v[i] + (1 - f.keep2) * slope * slope;
    p[i] = f.decay * p[i] - f.rate * m[i] / (std::sqrt(v[i]) * f.spread + f.eps);
  }
}

// One pass over the memory; the gradient is clipped on the way.
void adamw_step(const at::Tensor& parameter, torch::optim::AdamWParamState& state,
                const torch::optim::AdamWOptions& options, float shrink) {
  state.step(state.step() + 1);
  const double steps = static_cast<double>(state.step());
  const auto [beta1, beta2] = options.betas();
  const AdamWFactors factors{static_cast<float>(beta1),
                             static_cast<float>(beta2),
                             static_cast<float>(1 - options.lr() * options.weight_decay()),
                             static_cast<float>(options.lr() / (1 - std::pow(beta1, steps))),
                             static_cast<float>(1 / std::sqrt(1 - std::pow(beta2, steps))),
                             static_cast<float>(options.eps()),
                             shrink};
  float* value = parameter.data_ptr<float>();
  const float* grad = parameter.grad().data_ptr<float>();
  float* first = state.exp_avg().data_ptr<float>();
  float* second = state.exp_avg_sq().data_ptr<float>();
  at::parallel_for(0, parameter.numel(), 1 << 15, [&](std::int64_t begin, std::int64_t end) {
    adamw_elements(value + begin, grad + begin, first + begin, second + begin, end - begin,
                   factors);
  });
  parameter.unsafeGetTensorImpl()->bump_version();  // for copies made of it (packed_weights.h)
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
  for (at::Tensor& parameter : parameters_) parameter.mutable_grad() = at::Tensor();
}

double Optimizer::step(double learning_rate) {
  for (auto& group : adamw_->param_groups())
    static_cast<torch::optim::AdamWOptions&>(group.options()).lr(learning_rate);
  const bool fused = std::all_of(parameters_.begin(), parameters_.end(), [](const at::Tensor& p) {
    return !p.grad().defined() || is_plain(p, p.grad());
  });
  if (!fused) {
    const double limit = grad_clip_ > 0 ? grad_clip_ : std::numeric_limits<double>::infinity();
    const double norm = torch::nn::utils::clip_grad_norm_(parameters_, limit);
    if (std::isfinite(norm)) adamw_->step();
    return norm;
  }
  double squares = 0;
  for (const at::Tensor& p : parameters_)
    if (p.grad().defined()) squares += sum_of_squares(p.grad());
  const double norm = std::sqrt(squares);
  if (!std::isfinite(norm)) return norm;
  const double shrink = grad_clip_ > 0 ? std::min(1.0, grad_clip_ / (norm + 1e-6)) : 1;
  for (auto& group : adamw_->param_groups()) {
    const auto& options = static_cast<torch::optim::AdamWOptions&>(group.options());
    for (const at::Tensor& p : group.params())
      if (p.grad().defined())
        adamw_step(p, state_of(*adamw_, p), options, static_cast<float>(shrink));
  }
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
