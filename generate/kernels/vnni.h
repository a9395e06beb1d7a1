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

template <int Count>
struct Rows {
  static constexpr int value = Count;
};

// Calls tile(Rows<n>, first row, lines) for tiles of 6, 4, 2 and 1 rows. Each tile is a pass over
// the panel; of every four lines that the panel has, so many are asked for ahead in this pass, four
// in all. Sixteen rows are four equal passes.
template <class Tile>
inline void in_tiles(std::int64_t rows, const Tile& tile) {
  const std::int64_t sixes = rows % 4 == 0 && rows <= 16 ? 0 : rows / 6, left = rows - 6 * sixes,
                     passes = sixes + left / 4 + left % 4 / 2 + left % 2;
  std::int64_t pass = 0, r = 0;
  const auto lines = [&] {
    ++pass;
    return static_cast<int>(4 * pass / passes - 4 * (pass - 1) / passes);
  };
  for (; pass < sixes; r += 6) tile(Rows<6>(), r, lines());
  for (; r + 4 <= rows; r += 4) tile(Rows<4>(), r, lines());
  for (; r + 2 <= rows; r += 2) tile(Rows<2>(), r, lines());
  if (r < rows) tile(Rows<1>(), r, lines());
}

void prepare_vnni(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                  void* prepared, float* scale) {
  quantise<std::uint8_t, kOffset>(x, rows, in, depth, prepared, scale);
}

// For each depth step `lines` cache lines are asked for ahead.
template <int Count>
inline void tile_vnni(const std::uint8_t* x, std::int64_t depth, const std::uint32_t* panel,
                      const std::int32_t* sums, float* tile, Ahead& ahead, int lines) {
  constexpr int kVectors = kPanel / 16;
  __m512i sum[Count][kVectors];
  for (int r = 0; r < Count; ++r)
    for (int v = 0; v < kVectors; ++v)
      sum[r][v] =
          _mm512_mullo_epi32(_mm512_loadu_si512(sums + v * 16), _mm512_set1_epi32(-kOffset));
  Ahead next = ahead;
  for (std::int64_t k = 0; k < depth; ++k) {
    ask(next, lines);
    __m512i weights[kVectors];
    for (int v = 0; v < kVectors; ++v) weights[v] = _mm512_loadu_si512(panel + k * kPanel + v * 16);
    for (int r = 0; r < Count; ++r) {
      std::int32_t four;
      std::memcpy(&four, x + (r * depth + k) * 4, sizeof four);
      const __m512i left = _mm512_set1_epi32(four);
      for (int v = 0; v < kVectors; ++v)
        sum[r][v] = _mm512_dpbusd_epi32(sum[r][v], left, weights[v]);
    }
  }
  ahead = next;
  for (int r = 0; r < Count; ++r)
    for (int v = 0; v < kVectors; ++v)
      _mm512_storeu_ps(tile + r * kPanel + v * 16, _mm512_cvtepi32_ps(sum[r][v]));
}

void product_vnni(const void* prepared, std::int64_t rows, std::int64_t depth,
                  const std::uint32_t* panel, const std::int32_t* sums, float* tile, Ahead& ahead) {
  const auto* x = static_cast<const std::uint8_t*>(prepared);
  if (rows == 1) return tile_vnni<1>(x, depth, panel, sums, tile, ahead, 4);
  in_tiles(rows, [&](auto size, std::int64_t r, int lines) {
    tile_vnni<decltype(size)::value>(x + r * depth * 4, depth, panel, sums, tile + r * kPanel,
                                     ahead, lines);
  });
}

}  // namespace
}  // namespace mocaplm
