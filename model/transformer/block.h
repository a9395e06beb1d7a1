// One pre-norm transformer block (thesis Figure 4.1) and the output layer's product: written with
// LibTorch's operations, and on kernels of their own (cpu/block.h) where the products are in bf16
// and the processor has AVX512_BF16. Both draw the same dropout masks from the same seeds.
#pragma once

#include "model/transformer/packed_weights.h"
#include "model/transformer/torch.h"

namespace mocaplm {

struct BlockWeights {
  at::Tensor ln1_w, ln1_b;
  LinearWeights qkv, proj;
  at::Tensor ln2_w, ln2_b;
  LinearWeights up, down;
};

struct BlockOptions {
  std::int64_t heads;
  std::int64_t free;  // the last positions, which see the whole window (attention.h)
  double dropout;     // 0 outside training
  at::ScalarType precision;
};

// x (B, T, C) in f32 -> (B, T, C). Differentiable once.
at::Tensor transformer_block(const BlockWeights& weights, const at::Tensor& x,
                             const BlockOptions& options);
// The same with LibTorch's operations, on every device and in every precision.
at::Tensor plain_block(const BlockWeights& weights, const at::Tensor& x,
                       const BlockOptions& options);

// x w^T + b with the factors rounded to `type`, which the result has.
at::Tensor linear_in(at::ScalarType type, const LinearWeights& weights, const at::Tensor& x);

// Whether products of x in this precision may run on the kernels of cpu/, if these are available.
bool wants_kernels(const at::Tensor& x, at::ScalarType precision);

// x (N, C) w^T + b, (N, V), all in f32; where `precision` is bf16 and the kernels are there, the
// factors are rounded to it. Differentiable once.
at::Tensor output_linear(const LinearWeights& weights, const at::Tensor& x,
                         at::ScalarType precision);

}  // namespace mocaplm
