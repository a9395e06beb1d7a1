// Causal attention on processors with AVX512_BF16, forward and backward, computing only what the
// mask leaves: blocks of scores live in the cache and are never stored (FlashAttention, Dao et al.
// 2022, section 3; here with the whole row of a query block at once in the forward pass). Pointers
// only: the autograd function around it is in ../attention.cpp.
#pragma once

#include <cstdint>

namespace mocaplm::cpu {

using bf16 = std::uint16_t;  // the upper half of an f32

constexpr std::int64_t kMaxWidth = 256;

struct AttentionShape {
  std::int64_t batch, length, heads, width;  // B, T, H, D
  std::int64_t free;                         // the last queries, which attend to all T keys
  double dropout;                            // share of the attention weights set to 0
  std::uint64_t seed;                        // of the dropout
};

// Whether this processor can run the kernels and they can do this width (even, at most kMaxWidth).
bool attention_available(std::int64_t width);

// For the (batch, head) pairs `first` to `last` of B * H:
// qkv (B, T, 3, H, D) -> out (B, T, H, D), and the log of each query's softmax sum (B, H, T).
void attention_forward(const AttentionShape& shape, const bf16* qkv, bf16* out, float* log_sum,
                       std::int64_t first, std::int64_t last);
// Gradient of qkv (B, T, 3, H, D) from what the forward pass left and the gradient of `out`.
void attention_backward(const AttentionShape& shape, const bf16* qkv, const bf16* out,
                        const float* log_sum, const bf16* dout, bf16* dqkv, std::int64_t first,
                        std::int64_t last);

// 0 or 1 / (1 - p): the factor of the weight of query t for key s; the same for every thread count.
float dropout_factor(const AttentionShape& shape, std::int64_t pair, std::int64_t t,
                     std::int64_t s);

}  // namespace mocaplm::cpu
