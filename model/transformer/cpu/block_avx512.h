// What ../cpu/block.cpp hands out once it knows that the processor has the instructions.
#pragma once

#include "model/transformer/cpu/block.h"

namespace mocaplm::cpu {

// Columns of a weight gradient that one task computes for 64 rows.
constexpr std::int64_t kGradientColumns = 512;

namespace avx512 {

extern const BlockKernels kBlockKernels;

void layer_norm(const float* x, std::int64_t width, const float* weight, const float* bias, bf16* y,
                float* stats, std::int64_t first, std::int64_t last);
void layer_norm_backward(const bf16* dy, const float* x, const float* stats, std::int64_t width,
                         const float* weight, const float* residual, float* dx, float* dweight,
                         float* dbias, std::int64_t first, std::int64_t last);
void to_halves(const float* x, std::int64_t columns, const DropoutMask& mask, bf16* y,
               std::int64_t stride, std::int64_t first, std::int64_t last);
float softmax(float* z, std::int64_t n);
void weight_gradient(const bf16* dy, std::int64_t stride, const bf16* x, std::int64_t tokens,
                     std::int64_t rows, std::int64_t columns, float* dw, float* db,
                     std::int64_t first, std::int64_t last);

}  // namespace avx512

}  // namespace mocaplm::cpu
