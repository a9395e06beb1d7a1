// The second half of a transformer block by itself: y = x + down(GELU(up(norm(x)))). Written with
// LibTorch's operations, and on the kernels of cpu/block.h, as block.h has it.
#pragma once

#include "model/transformer/packed_weights.h"
#include "model/transformer/torch.h"

namespace mocaplm {

struct FeedForwardWeights {
  at::Tensor ln_w, ln_b;
  LinearWeights up, down;  // (wide, C), (C, wide)
};

// x (N, C) in f32 -> (N, C). Differentiable once.
at::Tensor feed_forward(const FeedForwardWeights& weights, const at::Tensor& x,
                        at::ScalarType precision);
// The same with LibTorch's operations, on every device and in every precision.
at::Tensor plain_feed_forward(const FeedForwardWeights& weights, const at::Tensor& x,
                              at::ScalarType precision);

}  // namespace mocaplm
