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

}  // namespace mocaplm
