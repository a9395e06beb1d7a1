#include "model/transformer/cpu/attention.h"

#include <cstdlib>

#include "model/transformer/cpu/attention_avx512.h"
#include "model/transformer/cpu/dropout_hash.h"
#include "model/transformer/cpu/features.h"

namespace mocaplm::cpu {

bool attention_available(std::int64_t width) {
  return has_avx512_bf16() && width % 2 == 0 && width > 0 && width <= kMaxWidth;
}

float dropout_factor(const AttentionShape& shape, std::int64_t pair, std::int64_t t,
                     std::int64_t s) {
  if (shape.dropout <= 0) return 1;
  const bool dropped = weight_hash(row_seed(shape.seed, pair, t), s) < drop_below(shape.dropout);
  return dropped ? 0.f : static_cast<float>(1 / (1 - shape.dropout));
}

#if defined(MOCAPLM_AVX512)

void attention_forward(const AttentionShape& shape, const bf16* qkv, bf16* out, float* log_sum,
                       std::int64_t first, std::int64_t last) {
  avx512::attention_forward(shape, qkv, out, log_sum, first, last);
}

void attention_backward(const AttentionShape& shape, const bf16* qkv, const bf16* out,
                        const float* log_sum, const bf16* dout, bf16* dqkv, std::int64_t first,
                        std::int64_t last) {
  avx512::attention_backward(shape, qkv, out, log_sum, dout, dqkv, first, last);
}

#else  // attention_available says no, so nobody calls these

void attention_forward(const AttentionShape&, const bf16*, bf16*, float*, std::int64_t,
                       std::int64_t) {
  std::abort();
}
void attention_backward(const AttentionShape&, const bf16*, const bf16*, const float*, const bf16*,
                        bf16*, std::int64_t, std::int64_t) {
  std::abort();
}

#endif

}  // namespace mocaplm::cpu
