// The kernels for AVX2 with FMA: the plain loops, but for the product of 8-bit numbers.
#include <immintrin.h>

#include "generate/kernels/bodies.h"

namespace mocaplm {
namespace {

// vpmaddubsw wants one unsigned factor: |x|, with the sign moved to the weight. Two products of
// numbers up to 127 fit in its 16 bits.
template <int Rows, int Vectors>
inline void tile_avx2(const std::int8_t* x, std::int64_t depth, const std::uint32_t* panel,
                      float* tile) {
  const __m256i ones = _mm256_set1_epi16(1);
  __m256i sums[Rows][Vectors];
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < Vectors; ++v) sums[r][v] = _mm256_setzero_si256();
  for (std::int64_t k = 0; k < depth; ++k)
    for (int r = 0; r < Rows; ++r) {
      std::int32_t four;
      std::memcpy(&four, x + (r * depth + k) * 4, sizeof four);
      const __m256i left = _mm256_set1_epi32(four), size = _mm256_abs_epi8(left);
      for (int v = 0; v < Vectors; ++v) {
        const __m256i weights =
            _mm256_loadu_si256(reinterpret_cast<const __m256i*>(panel + k * kPanel + v * 8));
        const __m256i pairs = _mm256_maddubs_epi16(size, _mm256_sign_epi8(weights, left));
        sums[r][v] = _mm256_add_epi32(sums[r][v], _mm256_madd_epi16(pairs, ones));
      }
    }
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < Vectors; ++v)
      _mm256_storeu_ps(tile + r * kPanel + v * 8, _mm256_cvtepi32_ps(sums[r][v]));
}

void product_int8_avx2(const void* prepared, std::int64_t rows, std::int64_t depth,
                       const std::uint32_t* panel, const std::int32_t*, float* tile, Ahead&) {
  const auto* x = static_cast<const std::int8_t*>(prepared);
  std::int64_t r = 0;
  for (; r + 2 <= rows; r += 2)
    for (std::int64_t c = 0; c < kPanel; c += 32)
      tile_avx2<2, 4>(x + r * depth * 4, depth, panel + c, tile + r * kPanel + c);
  for (; r < rows; ++r) tile_avx2<1, 8>(x + r * depth * 4, depth, panel, tile + r * kPanel);
}

}  // namespace

const Kernels kAvx2Kernels = {product_f32,       prepare_bf16, product_bf16, prepare_int8,
                              product_int8_avx2, attend_f32,   attend_bf16,  nullptr,
                              nullptr,           layer_norm,   store,        store_gelu,
                              store_sum};

}  // namespace mocaplm
