// Causal self-attention (thesis equation 4.1) that skips what the mask hides instead of computing
// it.
#pragma once

#include "model/transformer/torch.h"

namespace mocaplm {

// q, k, v: (B, H, T, D) in f32 or bf16. Query t attends to keys 0..t; the last `free` queries
// attend to all T keys (the classification tokens of thesis Figure 4.13). `dropout` acts on the
// attention weights. Returns (B, H, T, D). Differentiable once.
at::Tensor causal_attention(const at::Tensor& q, const at::Tensor& k, const at::Tensor& v,
                            std::int64_t free, double dropout);

// The same on qkv (B, T, 3, H, D) as the projection leaves it; returns (B, T, H, D). In bf16 on a
// processor with AVX512_BF16 it runs on kernels of its own (cpu/attention.h).
at::Tensor packed_causal_attention(const at::Tensor& qkv, std::int64_t free, double dropout);

}  // namespace mocaplm
