// The product of 8-bit numbers by VNNI, for the two files that are compiled with it.
#pragma once

#include <immintrin.h>

#include "generate/kernels/bodies.h"

namespace mocaplm {
namespace {

// vpdpbusd wants one unsigned factor: x + 128, whose share 128 * (sum of weights) is taken off at
// the start.
constexpr int kOffset = 128;

// Bytes that are asked for ahead of their use: what streams through memory once a token waits for
// it otherwise.
constexpr std::int64_t kAhead = 2048;

void prepare_vnni(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                  void* prepared, float* scale) {
  quantise<std::uint8_t, kOffset>(x, rows, in, depth, prepared, scale);
}

template <int Rows>
inline void tile_vnni(const std::uint8_t* x, std::int64_t depth, const std::uint32_t* panel,
                      const std::int32_t* sums, float* tile) {
  constexpr int kVectors = kPanel / 16;
  __m512i sum[Rows][kVectors];
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < kVectors; ++v)
      sum[r][v] =
          _mm512_mullo_epi32(_mm512_loadu_si512(sums + v * 16), _mm512_set1_epi32(-kOffset));
  for (std::int64_t k = 0; k < depth; ++k) {
    __m512i weights[kVectors];
    for (int v = 0; v < kVectors; ++v) weights[v] = _mm512_loadu_si512(panel + k * kPanel + v * 16);
    for (int r = 0; r < Rows; ++r) {
      std::int32_t four;
      std::memcpy(&four, x + (r * depth + k) * 4, sizeof four);
      const __m512i left = _mm512_set1_epi32(four);
      for (int v = 0; v < kVectors; ++v)
        sum[r][v] = _mm512_dpbusd_epi32(sum[r][v], left, weights[v]);
    }
  }
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < kVectors; ++v)
      _mm512_storeu_ps(tile + r * kPanel + v * 16, _mm512_cvtepi32_ps(sum[r][v]));
}

void product_vnni(const void* prepared, std::int64_t rows, std::int64_t depth,
                  const std::uint32_t* panel, const std::int32_t* sums, float* tile) {
  const auto* x = static_cast<const std::uint8_t*>(prepared);
  std::int64_t r = 0;
  for (; r + 6 <= rows; r += 6)
    tile_vnni<6>(x + r * depth * 4, depth, panel, sums, tile + r * kPanel);
  for (; r + 4 <= rows; r += 4)
    tile_vnni<4>(x + r * depth * 4, depth, panel, sums, tile + r * kPanel);
  for (; r + 2 <= rows; r += 2)
    tile_vnni<2>(x + r * depth * 4, depth, panel, sums, tile + r * kPanel);
  if (r < rows) tile_vnni<1>(x + r * depth * 4, depth, panel, sums, tile + r * kPanel);
}

}  // namespace
}  // namespace mocaplm
