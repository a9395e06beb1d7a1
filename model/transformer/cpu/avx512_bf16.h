// Building blocks for files compiled with AVX-512 and AVX512_BF16: only such files may include
// this, and nothing here is seen outside them (a copy that the linker kept for others would crash
// on lesser processors).
#pragma once

#include <immintrin.h>

#include <cstdint>
#include <cstring>

namespace mocaplm::cpu {
namespace {

constexpr std::int64_t kLanes = 16;  // f32 values of a register
constexpr std::int64_t kPanel = 64;  // columns of a packed panel

inline std::int64_t round_up(std::int64_t value, std::int64_t step) {
  return (value + step - 1) / step * step;
}

inline __m512bh pairs(const std::uint16_t* p) {
  return (__m512bh)_mm512_loadu_si512(p);
}

inline __m512bh same_pair(const std::uint16_t* p) {
  std::int32_t two;
  std::memcpy(&two, p, sizeof two);
  return (__m512bh)_mm512_set1_epi32(two);
}

inline __m256i to_bf16(__m512 x) {
  return (__m256i)_mm512_cvtneps_pbh(x);
}

inline __m512 to_f32(__m256i x) {
  return _mm512_castsi512_ps(_mm512_slli_epi32(_mm512_cvtepu16_epi32(x), 16));
}

// Rows a and b interleaved in bf16: a0 b0 a1 b1 ...
inline __m512i interleaved(__m512 a, __m512 b) {
  return _mm512_or_si512(_mm512_cvtepu16_epi32(to_bf16(a)),
                         _mm512_slli_epi32(_mm512_cvtepu16_epi32(to_bf16(b)), 16));
}

// e^x for x <= 88: 2^n times a polynomial on [-ln 2 / 2, ln 2 / 2] (Taylor to the sixth power:
// relative error under 2e-7); 0 far below.
inline __m512 exponential(__m512 x) {
  const __m512 n = _mm512_roundscale_ps(_mm512_mul_ps(x, _mm512_set1_ps(1.44269504f)),
                                        _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  const __m512 r = _mm512_fnmadd_ps(n, _mm512_set1_ps(1.42860677e-6f),
                                    _mm512_fnmadd_ps(n, _mm512_set1_ps(0.693145752f), x));
  __m512 p = _mm512_set1_ps(1.f / 720);
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(1.f / 120));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(1.f / 24));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(1.f / 6));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(0.5f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(1.f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(1.f));
  return _mm512_scalef_ps(p, n);
}

// The right factor of a product, as the processor's dot products of pairs want it: panels of up to
// kPanel columns, a panel row after row of pairs, `columns` a multiple of kLanes.
struct Packed {
  const std::uint16_t* data;
  std::int64_t depth2;   // pairs along the sum
  std::int64_t columns;  // that take part
  std::int64_t used2;    // the first so many pairs take part
};

// c (Rows, 16 Vectors) (+)= a (Rows, 2 depth2) times one panel.
template <int Rows, int Vectors>
inline void tile(const std::uint16_t* a, std::int64_t lda, const std::uint16_t* b,
                 std::int64_t depth2, float* c, std::int64_t ldc, bool add) {
  __m512 sum[Rows][Vectors];
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < Vectors; ++v) sum[r][v] = _mm512_setzero_ps();
  for (std::int64_t k = 0; k < depth2; ++k) {
    __m512bh right[Vectors];
    for (int v = 0; v < Vectors; ++v) right[v] = pairs(b + (k * Vectors + v) * 2 * kLanes);
    for (int r = 0; r < Rows; ++r) {
      const __m512bh left = same_pair(a + r * lda + 2 * k);
      for (int v = 0; v < Vectors; ++v) sum[r][v] = _mm512_dpbf16_ps(sum[r][v], left, right[v]);
    }
  }
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < Vectors; ++v) {
      float* to = c + r * ldc + v * kLanes;
      _mm512_storeu_ps(to, add ? _mm512_add_ps(sum[r][v], _mm512_loadu_ps(to)) : sum[r][v]);
    }
}

template <int Vectors>
inline void panel_product(const std::uint16_t* a, std::int64_t lda, std::int64_t rows,
                          const std::uint16_t* b, std::int64_t depth2, float* c, std::int64_t ldc,
                          bool add) {
  std::int64_t r = 0;
  for (; r + 6 <= rows; r += 6)
    tile<6, Vectors>(a + r * lda, lda, b, depth2, c + r * ldc, ldc, add);
  a += r * lda;
  c += r * ldc;
  switch (rows - r) {
    case 5:
      return tile<5, Vectors>(a, lda, b, depth2, c, ldc, add);
    case 4:
      return tile<4, Vectors>(a, lda, b, depth2, c, ldc, add);
    case 3:
      return tile<3, Vectors>(a, lda, b, depth2, c, ldc, add);
    case 2:
      return tile<2, Vectors>(a, lda, b, depth2, c, ldc, add);
    case 1:
      return tile<1, Vectors>(a, lda, b, depth2, c, ldc, add);
    default:
      return;
  }
}

// c (rows, b.columns) (+)= a (rows, 2 b.used2), row-major bf16, times b; sums in f32.
inline void product(const std::uint16_t* a, std::int64_t lda, std::int64_t rows, const Packed& b,
                    float* c, std::int64_t ldc, bool add) {
  for (std::int64_t column = 0; column < b.columns; column += kPanel) {
    const std::uint16_t* panel = b.data + column * 2 * b.depth2;
    const std::int64_t left = b.columns - column;
    if (left >= 64)
      panel_product<4>(a, lda, rows, panel, b.used2, c + column, ldc, add);
    else if (left == 48)
      panel_product<3>(a, lda, rows, panel, b.used2, c + column, ldc, add);
    else if (left == 32)
      panel_product<2>(a, lda, rows, panel, b.used2, c + column, ldc, add);
    else
      panel_product<1>(a, lda, rows, panel, b.used2, c + column, ldc, add);
  }
}

// Where element (pair row k, column) of a panelled factor begins; two values, depth2 rows a panel.
inline std::uint16_t* place(std::uint16_t* packed, std::int64_t depth2, std::int64_t columns,
                            std::int64_t k, std::int64_t column) {
  const std::int64_t first = column / kPanel * kPanel;
  const std::int64_t wide = columns - first < kPanel ? columns - first : kPanel;
  return packed + first * 2 * depth2 + (k * wide + column - first) * 2;
}

// x (rows, width) as the factor of a sum over its rows: depth2 pairs of rows (zeros past the end),
// `columns` >= width (zeros past the width).
inline void pack_rows(const std::uint16_t* x, std::int64_t stride, std::int64_t rows,
                      std::int64_t width, std::int64_t depth2, std::int64_t columns,
                      std::uint16_t* packed) {
  for (std::int64_t k = 0; k < depth2; ++k)
    for (std::int64_t c = 0; c < columns; ++c) {
      std::uint16_t* to = place(packed, depth2, columns, k, c);
      to[0] = c < width && 2 * k < rows ? x[2 * k * stride + c] : 0;
      to[1] = c < width && 2 * k + 1 < rows ? x[(2 * k + 1) * stride + c] : 0;
    }
}

// x (rows, 2 depth2) transposed, as the factor of a sum over its width: `columns` >= rows.
inline void pack_transposed(const std::uint16_t* x, std::int64_t stride, std::int64_t rows,
                            std::int64_t depth2, std::int64_t columns, std::uint16_t* packed) {
  for (std::int64_t first = 0; first < columns; first += kPanel) {
    const std::int64_t wide = columns - first < kPanel ? columns - first : kPanel;
    std::uint16_t* panel = packed + first * 2 * depth2;
    for (std::int64_t c = 0; c < wide; ++c)
      for (std::int64_t k = 0; k < depth2; ++k) {
        std::uint32_t two = 0;
        if (first + c < rows) std::memcpy(&two, x + (first + c) * stride + 2 * k, sizeof two);
        std::memcpy(panel + (k * wide + c) * 2, &two, sizeof two);
      }
  }
}

}  // namespace
}  // namespace mocaplm::cpu
