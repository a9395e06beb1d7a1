// The output layer: logits over ids, optionally with logits over the distance to the linear
// extrapolation of the same channel shifted into place, and the cross-entropy (thesis equation 4.4)
// over their sum.
#pragma once

#include "model/transformer/torch.h"

namespace mocaplm {

struct BinRange {
  std::int64_t first;  // id of bin 0
  std::int64_t count;
};

// absolute: (N, V). offsets: (N, 2 * reach + 1), or undefined for the thesis's plain output.
// centre: (N) int64, the bin that extrapolation predicts, kNoCentre for none.
// Bin b gets absolute[first + b] + offsets[clamp(b - centre, -reach, reach) + reach]. Returns (N,
// V).
at::Tensor combined_logits(const at::Tensor& absolute, const at::Tensor& offsets,
                           const at::Tensor& centre, const BinRange& bins);

// Cross-entropy in nats of each row, (N); 0 where target (N, int64) is negative. On the CPU in f32
// one fused pass forward and backward; elsewhere combined_logits and log_softmax.
at::Tensor combined_cross_entropy(const at::Tensor& absolute, const at::Tensor& offsets,
                                  const at::Tensor& centre, const at::Tensor& target,
                                  const BinRange& bins);

}  // namespace mocaplm
