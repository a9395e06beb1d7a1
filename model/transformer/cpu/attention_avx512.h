// What ../cpu/attention.cpp calls once it knows that the processor has the instructions.
#pragma once

#include "model/transformer/cpu/attention.h"

namespace mocaplm::cpu::avx512 {

void attention_forward(const AttentionShape& shape, const bf16* qkv, bf16* out, float* log_sum,
                       std::int64_t first, std::int64_t last);
void attention_backward(const AttentionShape& shape, const bf16* qkv, const bf16* out,
                        const float* log_sum, const bf16* dout, bf16* dqkv, std::int64_t first,
                        std::int64_t last);

}  // namespace mocaplm::cpu::avx512
