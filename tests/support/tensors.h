// How far tensors are apart.
#pragma once

#include "model/transformer/torch.h"

namespace mocaplm {

inline double largest_difference(const at::Tensor& a, const at::Tensor& b) {
  return (a.to(at::kDouble) - b.to(at::kDouble)).abs().max().item<double>();
}

}  // namespace mocaplm
