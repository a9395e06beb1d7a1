// What the forward and the backward kernel share. Only for files compiled with AVX-512
// (avx512_bf16.h).
#pragma once

#include <cmath>
#include <cstdlib>

#include "model/transformer/cpu/attention.h"
#include "model/transformer/cpu/avx512_bf16.h"
#include "model/transformer/cpu/dropout_hash.h"

namespace mocaplm::cpu {
namespace {

// Sizes and strides that every step needs.
struct Sizes {
  explicit Sizes(const AttentionShape& s)
      : length(s.length),
        width(s.width),
        stride(3 * s.heads * s.width),
        out_stride(s.heads * s.width),
        wide(round_up(s.width, kLanes)),
        padded(round_up(s.length, kPanel)),
        first_free(s.length - s.free),
        scale(1 / std::sqrt(static_cast<float>(s.width))) {}

  // Keys that query t sees.
  std::int64_t limit(std::int64_t t) const { return t < first_free ? t + 1 : length; }

  std::int64_t length, width, stride, out_stride, wide, padded, first_free;
  float scale;
};

// Factors of dropout for 16 weights: rows' seeds and keys as vectors.
struct Dropout {
  explicit Dropout(double p)
      : on(p > 0),
        below(_mm512_set1_epi32(static_cast<int>(drop_below(p)))),
        kept(_mm512_set1_ps(static_cast<float>(1 / (1 - p)))) {}

  __m512 factor(__m512i rows, __m512i keys) const {
    const __m512i mix1 = _mm512_set1_epi32(static_cast<int>(kMix1)),
                  mix2 = _mm512_set1_epi32(static_cast<int>(kMix2));
    __m512i x = _mm512_add_epi32(
        rows, _mm512_mullo_epi32(keys, _mm512_set1_epi32(static_cast<int>(kKeyStep))));
    x = _mm512_mullo_epi32(_mm512_xor_si512(x, _mm512_srli_epi32(x, 16)), mix1);
    x = _mm512_mullo_epi32(_mm512_xor_si512(x, _mm512_srli_epi32(x, 15)), mix2);
    x = _mm512_srli_epi32(_mm512_xor_si512(x, _mm512_srli_epi32(x, 16)), 32 - kHashBits);
    return _mm512_maskz_mov_ps(_mm512_cmpge_epu32_mask(x, below), kept);
  }

  bool on;
  __m512i below;
  __m512 kept;
};

inline __m512i counting(std::int64_t from) {
  return _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(from)),
                          _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
}

// x (width) times factor, as bf16.
inline void store_row(const float* x, __m512 factor, std::int64_t width, bf16* to) {
  for (std::int64_t c = 0; c < width; c += kLanes)
    _mm256_mask_storeu_epi16(to + c, first_lanes(width - c),
                             to_bf16(_mm512_mul_ps(_mm512_loadu_ps(x + c), factor)));
}

}  // namespace
}  // namespace mocaplm::cpu
