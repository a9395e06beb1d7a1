// What the block's kernels share. Only for files compiled with AVX-512 (avx512_bf16.h).
#pragma once

#include "model/transformer/cpu/avx512_bf16.h"
#include "model/transformer/cpu/block_avx512.h"

namespace mocaplm::cpu {
namespace {

constexpr std::int64_t kDepth = 512;  // of a sum at a time

inline __m512 load_halves(__mmask16 lanes, const bf16* from) {
  return to_f32(_mm256_maskz_loadu_epi16(lanes, from));
}
inline void store_halves(bf16* to, __mmask16 lanes, __m512 x) {
  _mm256_mask_storeu_epi16(to, lanes, to_bf16(x));
}

// The mask that ../dropout.cpp draws: SplitMix64 of the seed and the index over four, 16 bits an
// element.
struct Dropping {
  explicit Dropping(const DropoutMask& mask)
      : on(mask.p > 0),
        seed(mask.seed),
        below(_mm256_set1_epi16(static_cast<short>(static_cast<int>(mask.p * 65536)))),
        kept(_mm512_set1_ps(static_cast<float>(
            1 / (1 - static_cast<double>(static_cast<int>(mask.p * 65536)) / 65536)))) {}

  // The factors of 16 elements from `index` on, a multiple of 4.
  __m512 factor(std::int64_t index) const {
    const auto constant = [](std::uint64_t value) {
      return _mm256_set1_epi64x(static_cast<long long>(value));
    };
    __m256i x = _mm256_add_epi64(
        constant(seed + static_cast<std::uint64_t>(index) / 4 + 0x9e3779b97f4a7c15ULL),
        _mm256_setr_epi64x(0, 1, 2, 3));
    x = _mm256_mullo_epi64(_mm256_xor_si256(x, _mm256_srli_epi64(x, 30)),
                           constant(0xbf58476d1ce4e5b9ULL));
    x = _mm256_mullo_epi64(_mm256_xor_si256(x, _mm256_srli_epi64(x, 27)),
                           constant(0x94d049bb133111ebULL));
    x = _mm256_xor_si256(x, _mm256_srli_epi64(x, 31));
    return _mm512_maskz_mov_ps(_mm256_cmpge_epu16_mask(x, below), kept);
  }

  bool on;
  std::uint64_t seed;
  __m256i below;
  __m512 kept;
};

}  // namespace
}  // namespace mocaplm::cpu
