// The parts of block.h that run on the kernels of cpu/; callers ask cpu::block_available first.
#pragma once

#include "model/transformer/block.h"

namespace mocaplm {

at::Tensor fused_block(const BlockWeights& weights, const at::Tensor& x,
                       const BlockOptions& options);
at::Tensor fused_output_linear(const LinearWeights& weights, const at::Tensor& x);

}  // namespace mocaplm
