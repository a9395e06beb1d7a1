#include "train/adamw.h"

#include <ATen/Parallel.h>

#include <cmath>
#include <numeric>

namespace mocaplm {

namespace {

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

void fused_step(const at::Tensor& parameter, AdamWState& state, const AdamWFactors& factors) {
  float* value = parameter.data_ptr<float>();
  const float* grad = parameter.grad().data_ptr<float>();
  float* first = state.first.data_ptr<float>();
  float* second = state.second.data_ptr<float>();
  at::parallel_for(0, parameter.numel(), 1 << 15, [&](std::int64_t begin, std::int64_t end) {
    adamw_elements(value + begin, grad + begin, first + begin, second + begin, end - begin,
                   factors);
  });
  parameter.unsafeGetTensorImpl()->bump_version();  // for copies made of it (packed_weights.h)
}

void plain_step(const at::Tensor& parameter, AdamWState& state, const AdamWFactors& f) {
  const at::NoGradGuard no_grad;
  const at::Tensor slope = parameter.grad() * f.shrink;
  state.first.mul_(f.keep1).add_(slope, 1 - f.keep1);
  state.second.mul_(f.keep2).addcmul_(slope, slope, 1 - f.keep2);
  const at::Tensor spread = state.second.sqrt().mul_(f.spread).add_(f.eps);
  at::Tensor(parameter).mul_(f.decay).addcdiv_(state.first, spread, -f.rate);
}

}  // namespace

double gradient_norm(const std::vector<at::Tensor>& parameters) {
  double squares = 0;
  std::vector<at::Tensor> others;
  for (const at::Tensor& p : parameters) {
    if (!p.grad().defined()) continue;
    if (is_plain(p, p.grad()))
      squares += sum_of_squares(p.grad());
    else
      others.push_back(p.grad().norm().to(at::kDouble));
  }
  if (!others.empty()) squares += at::stack(others).square().sum().item<double>();
  return std::sqrt(squares);
}

void adamw_step(const at::Tensor& parameter, AdamWState& state, const AdamWRates& rates) {
  if (!state.first.defined()) {
    state.first = at::zeros_like(parameter, at::MemoryFormat::Contiguous);
    state.second = at::zeros_like(parameter, at::MemoryFormat::Contiguous);
  }
  const auto steps = static_cast<double>(++state.steps);
  const AdamWFactors factors{
      static_cast<float>(rates.beta1),
      static_cast<float>(rates.beta2),
      static_cast<float>(1 - rates.learning_rate * rates.decay),
      static_cast<float>(rates.learning_rate / (1 - std::pow(rates.beta1, steps))),
      static_cast<float>(1 / std::sqrt(1 - std::pow(rates.beta2, steps))),
      static_cast<float>(rates.epsilon),
      static_cast<float>(rates.shrink)};
  if (is_plain(parameter, parameter.grad()))
    fused_step(parameter, state, factors);
  else
    plain_step(parameter, state, factors);
}

}  // namespace mocaplm
