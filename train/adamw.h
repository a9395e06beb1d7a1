// AdamW (Loshchilov and Hutter 2019, algorithm 2) for one parameter, and the norm of all gradients.
// On the CPU, for f32, in one pass over the memory; elsewhere by LibTorch's operations.
#pragma once

#include <vector>

#include "model/transformer/torch.h"

namespace mocaplm {

struct AdamWState {
  at::Tensor first,
      second;  // moving averages of the gradient and of its square; undefined at first
  std::int64_t steps = 0;
};

struct AdamWRates {
  double learning_rate = 0, beta1 = 0.9, beta2 = 0.95, epsilon = 1e-8;
  double decay = 0;   // weight decay
  double shrink = 1;  // of the gradient, before anything else
};

// Euclidean norm of all gradients that are there; the same for any number of threads.
double gradient_norm(const std::vector<at::Tensor>& parameters);

// `parameter` must have a gradient, which stays as it is.
void adamw_step(const at::Tensor& parameter, AdamWState& state, const AdamWRates& rates);

}  // namespace mocaplm
