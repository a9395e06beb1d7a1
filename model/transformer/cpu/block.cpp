#include "model/transformer/cpu/block.h"

#include "model/transformer/cpu/block_avx512.h"
#include "model/transformer/cpu/features.h"

namespace mocaplm::cpu {

namespace {

std::int64_t over(std::int64_t value, std::int64_t step) {
  return (value + step - 1) / step;
}

}  // namespace

const BlockKernels* block_kernels() {
#if defined(MOCAPLM_AVX512)
  if (has_avx512_bf16()) return &avx512::kBlockKernels;
#endif
  return nullptr;
}

bool products_available(std::int64_t depth) {
  return block_kernels() != nullptr && depth % 16 == 0;
}

bool block_available(std::int64_t width, std::int64_t heads) {
  return products_available(width) && attention_available(width / heads);
}

std::int64_t packed_size(std::int64_t depth, std::int64_t columns) {
  return depth * over(columns, 16) * 16;
}

std::int64_t packed_panels(std::int64_t columns) {
  return over(columns, 64);
}

std::int64_t gradient_tasks(std::int64_t rows, std::int64_t columns) {
  return over(rows, 64) * over(columns, kGradientColumns);
}

}  // namespace mocaplm::cpu
