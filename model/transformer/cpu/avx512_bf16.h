// Building blocks for files compiled with AVX-512 and AVX512_BF16: only such files may include
// this, and nothing here is seen outside them (a copy that the linker kept for others would crash
// on lesser processors).
#pragma once

#include <immintrin.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace mocaplm::cpu {
namespace {

constexpr std::int64_t kLanes = 16;  // f32 values of a register
constexpr std::int64_t kPanel = 64;  // columns of a packed panel

inline std::int64_t round_up(std::int64_t value, std::int64_t step) {
  return (value + step - 1) / step * step;
}

// The first n of 16 lanes.
inline __mmask16 first_lanes(std::int64_t n) {
  return static_cast<__mmask16>(n >= kLanes ? 0xFFFF : n <= 0 ? 0 : (1 << n) - 1);
}

// Fetches `bytes` from p on ahead of their use; p may lie past the end of anything.
inline void fetch(const void* p, std::int64_t bytes) {
  for (std::int64_t at = 0; at < bytes; at += 64)
    _mm_prefetch(static_cast<const char*>(p) + at, _MM_HINT_T0);
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

// Rows a and b interleaved: a0 b0 a1 b1 ..., from a in the lower and b in the upper half.
inline __m512i interleaved(__m512i both) {
  alignas(64) static constexpr std::uint16_t kOrder[32] = {
      0, 16, 1, 17, 2,  18, 3,  19, 4,  20, 5,  21, 6,  22, 7,  23,
      8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31};
  return _mm512_permutexvar_epi16(_mm512_load_si512(kOrder), both);
}
inline __m512i to_bf16(__m512 a, __m512 b) {
  return (__m512i)_mm512_cvtne2ps_pbh(b, a);
}
inline __m512i joined(__m256i a, __m256i b) {
  return _mm512_inserti64x4(_mm512_castsi256_si512(a), b, 1);
}

// 2^x for x <= 127: a power of two times a polynomial on [-1/2, 1/2] (relative error under 3e-7); 0
// far below.
inline __m512 power_of_two(__m512 x) {
  const __m512 n = _mm512_roundscale_ps(x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  const __m512 r = _mm512_sub_ps(x, n);
  __m512 p = _mm512_set1_ps(1.33935747e-3f);
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(9.67023615e-3f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(5.55033986e-2f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(2.40222469e-1f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(6.93147187e-1f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(1.f));
  return _mm512_scalef_ps(p, n);
}

// The same to 8e-5, a twentieth of what rounding the result to bf16 may cost.
inline __m512 rough_power_of_two(__m512 x) {
  const __m512 n = _mm512_roundscale_ps(x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  const __m512 r = _mm512_sub_ps(x, n);
  __m512 p = _mm512_set1_ps(0.0551716691f);
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(0.242611122f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(0.693260985f));
  p = _mm512_fmadd_ps(p, r, _mm512_set1_ps(0.999928074f));
  return _mm512_scalef_ps(p, n);
}

constexpr float kLog2E = 1.44269504f;

// The right factor of a product, as the processor's dot products of pairs want it: panels of up to
// kPanel columns, a panel row after row of pairs, `columns` a multiple of kLanes.
struct Packed {
  const std::uint16_t* data;
  std::int64_t depth2;   // pairs along the sum
  std::int64_t columns;  // that take part
  std::int64_t used2;    // the first so many pairs take part
};

// Memory that a thread keeps from call to call: fresh pages cost more than many a kernel's work.
inline char* kept_memory(std::int64_t bytes) {
  struct Kept {
    ~Kept() { std::free(data); }
    char* data = nullptr;
    std::int64_t size = 0;
  };
  thread_local Kept kept;
  if (kept.size < bytes) {
    std::free(kept.data);
    kept.data = static_cast<char*>(std::aligned_alloc(64, static_cast<std::size_t>(bytes)));
    if (kept.data == nullptr) std::abort();
    kept.size = bytes;
  }
  return kept.data;
}

// One piece of memory, handed out in parts that begin on cache lines; one at a time in a thread.
class Scratch {
 public:
  explicit Scratch(std::int64_t bytes) : data_(kept_memory(bytes)) {}
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  static std::int64_t bytes(std::int64_t count, std::int64_t size) {
    return round_up(count * size, 64);
  }
  float* floats(std::int64_t count) { return reinterpret_cast<float*>(take(bytes(count, 4))); }
  std::uint16_t* halves(std::int64_t count) {
    return reinterpret_cast<std::uint16_t*>(take(bytes(count, 2)));
  }
  std::uint32_t* words(std::int64_t count) {
    return reinterpret_cast<std::uint32_t*>(take(bytes(count, 4)));
  }

 private:
  char* take(std::int64_t size) {
    char* part = data_ + used_;
    used_ += size;
    return part;
  }
  char* data_;
  std::int64_t used_ = 0;
};

// The left factor of a product: where its rows begin, and the step from one row, and from one pair
// of the sum, to the next (2 where rows lie whole).
struct Left {
  const std::uint16_t* data;
  std::int64_t row, pair;
};

// c (Rows, 16 Vectors) (+)= a (Rows, 2 depth2) times one panel. The loops over rows and vectors are
// unrolled whole: otherwise GCC keeps the sums in memory at the end. Sums so far that lie far away
// (of long products) are fetched ahead.
template <int Rows, int Vectors>
inline void tile(const Left& a, const std::uint16_t* b, std::int64_t depth2, float* c,
                 std::int64_t ldc, bool add) {
  __m512 sum[Rows][Vectors];
#pragma GCC unroll 12
  for (int r = 0; r < Rows; ++r)
#pragma GCC unroll 4
    for (int v = 0; v < Vectors; ++v) {
      sum[r][v] = _mm512_setzero_ps();
      if (add && depth2 >= 64)
        _mm_prefetch(reinterpret_cast<const char*>(c + r * ldc + v * kLanes), _MM_HINT_T0);
    }
  const std::uint16_t* left = a.data;
  for (std::int64_t k = 0; k < depth2; ++k, left += a.pair) {
    __m512bh right[Vectors];
#pragma GCC unroll 4
    for (int v = 0; v < Vectors; ++v) right[v] = pairs(b + (k * Vectors + v) * 2 * kLanes);
#pragma GCC unroll 12
    for (int r = 0; r < Rows; ++r) {
      const __m512bh one = same_pair(left + r * a.row);
#pragma GCC unroll 4
      for (int v = 0; v < Vectors; ++v) sum[r][v] = _mm512_dpbf16_ps(sum[r][v], one, right[v]);
    }
  }
  if (add) {
#pragma GCC unroll 12
    for (int r = 0; r < Rows; ++r)
#pragma GCC unroll 4
      for (int v = 0; v < Vectors; ++v)
        sum[r][v] = _mm512_add_ps(sum[r][v], _mm512_loadu_ps(c + r * ldc + v * kLanes));
  }
#pragma GCC unroll 12
  for (int r = 0; r < Rows; ++r)
#pragma GCC unroll 4
    for (int v = 0; v < Vectors; ++v) _mm512_storeu_ps(c + r * ldc + v * kLanes, sum[r][v]);
}

// Rows of a tile that leave registers for the right factor and one value of the left.
constexpr int tile_rows(int vectors) {
  return vectors == 4 ? 6 : vectors == 3 ? 8 : 12;
}

template <int Vectors>
inline void panel_product(Left a, std::int64_t rows, const std::uint16_t* b, std::int64_t depth2,
                          float* c, std::int64_t ldc, bool add) {
  constexpr int kRows = tile_rows(Vectors);
  for (; rows >= kRows; rows -= kRows, a.data += kRows * a.row, c += kRows * ldc)
    tile<kRows, Vectors>(a, b, depth2, c, ldc, add);
  if (rows >= 6) {
    tile<6, Vectors>(a, b, depth2, c, ldc, add);
    rows -= 6, a.data += 6 * a.row, c += 6 * ldc;
  }
  switch (rows) {
    case 5:
      return tile<5, Vectors>(a, b, depth2, c, ldc, add);
    case 4:
      return tile<4, Vectors>(a, b, depth2, c, ldc, add);
    case 3:
      return tile<3, Vectors>(a, b, depth2, c, ldc, add);
    case 2:
      return tile<2, Vectors>(a, b, depth2, c, ldc, add);
    case 1:
      return tile<1, Vectors>(a, b, depth2, c, ldc, add);
    default:
      return;
  }
}

// The same for one panel of `wide` columns, 16 to kPanel.
inline void panel_product(const Left& a, std::int64_t rows, std::int64_t wide,
                          const std::uint16_t* b, std::int64_t depth2, float* c, std::int64_t ldc,
                          bool add) {
  if (wide == 64)
    panel_product<4>(a, rows, b, depth2, c, ldc, add);
  else if (wide == 48)
    panel_product<3>(a, rows, b, depth2, c, ldc, add);
  else if (wide == 32)
    panel_product<2>(a, rows, b, depth2, c, ldc, add);
  else
    panel_product<1>(a, rows, b, depth2, c, ldc, add);
}

// c (rows, b.columns) (+)= a (rows, 2 b.used2) in bf16 times b; sums in f32.
inline void product(const Left& a, std::int64_t rows, const Packed& b, float* c, std::int64_t ldc,
                    bool add) {
  for (std::int64_t column = 0; column < b.columns; column += kPanel) {
    const std::int64_t left = b.columns - column;
    panel_product(a, rows, left < kPanel ? left : kPanel, b.data + column * 2 * b.depth2, b.used2,
                  c + column, ldc, add);
  }
}

// Some rows of up to 64 columns as pairs of rows: [pair][wide][2], zeros past the rows and the
// width.
inline void interleave(const std::uint16_t* x, std::int64_t stride, std::int64_t rows,
                       std::int64_t width, std::int64_t wide, std::uint16_t* to) {
  for (std::int64_t t = 0; t < rows; t += 2, x += 2 * stride)
    for (std::int64_t c = 0; c < wide; c += kLanes, to += 2 * kLanes) {
      const __mmask16 lanes = first_lanes(width - c);
      _mm_prefetch(reinterpret_cast<const char*>(x + 16 * stride + c), _MM_HINT_T0);
      _mm_prefetch(reinterpret_cast<const char*>(x + 17 * stride + c), _MM_HINT_T0);
      const __m256i one = _mm256_maskz_loadu_epi16(lanes, x + c);
      const __m256i two = _mm256_maskz_loadu_epi16(t + 1 < rows ? lanes : 0, x + stride + c);
      _mm512_storeu_si512(to, interleaved(joined(one, two)));
    }
}

// x (rows, width) as the factor of a sum over its rows: depth2 pairs of rows (zeros past the end),
// `columns` >= width (zeros past the width), a multiple of kLanes.
inline void pack_rows(const std::uint16_t* x, std::int64_t stride, std::int64_t rows,
                      std::int64_t width, std::int64_t depth2, std::int64_t columns,
                      std::uint16_t* packed) {
  for (std::int64_t first = 0; first < columns; first += kPanel) {
    const std::int64_t wide = columns - first < kPanel ? columns - first : kPanel;
    std::uint16_t* panel = packed + first * 2 * depth2;
    interleave(x + first, stride, rows, width - first, wide, panel);
    const std::int64_t filled = (rows + 1) / 2 * wide * 2, all = depth2 * wide * 2;
    std::memset(panel + filled, 0, static_cast<std::size_t>(all - filled) * sizeof *panel);
  }
}

// 16 rows of 16 words become 16 columns.
inline void transpose(__m512i r[16]) {
  __m512i t[16];
  for (int i = 0; i < 16; i += 2) {
    t[i] = _mm512_unpacklo_epi32(r[i], r[i + 1]);
    t[i + 1] = _mm512_unpackhi_epi32(r[i], r[i + 1]);
  }
  for (int i = 0; i < 16; i += 4) {
    r[i] = _mm512_unpacklo_epi64(t[i], t[i + 2]);
    r[i + 1] = _mm512_unpackhi_epi64(t[i], t[i + 2]);
    r[i + 2] = _mm512_unpacklo_epi64(t[i + 1], t[i + 3]);
    r[i + 3] = _mm512_unpackhi_epi64(t[i + 1], t[i + 3]);
  }
  for (int i = 0; i < 4; ++i) {  // lanes of four words: 4 by 4 of them
    t[i] = _mm512_shuffle_i32x4(r[i], r[i + 4], 0x88);
    t[i + 4] = _mm512_shuffle_i32x4(r[i], r[i + 4], 0xdd);
    t[i + 8] = _mm512_shuffle_i32x4(r[i + 8], r[i + 12], 0x88);
    t[i + 12] = _mm512_shuffle_i32x4(r[i + 8], r[i + 12], 0xdd);
  }
  for (int i = 0; i < 4; ++i) {
    r[i] = _mm512_shuffle_i32x4(t[i], t[i + 8], 0x88);
    r[i + 8] = _mm512_shuffle_i32x4(t[i], t[i + 8], 0xdd);
    r[i + 4] = _mm512_shuffle_i32x4(t[i + 4], t[i + 12], 0x88);
    r[i + 12] = _mm512_shuffle_i32x4(t[i + 4], t[i + 12], 0xdd);
  }
}

// One panel of `wide` columns of a factor of depth2 pairs, from its columns: pair(column, k) gives
// 16 pairs of a column from pair k on (zeros past its end).
template <class Column>
inline void pack_columns(std::int64_t wide, std::int64_t depth2, const Column& column,
                         std::uint16_t* panel) {
  for (std::int64_t c = 0; c < wide; c += kLanes)
    for (std::int64_t k = 0; k < depth2; k += kLanes) {
      __m512i block[16];
      for (int i = 0; i < 16; ++i) block[i] = column(c + i, k);
      transpose(block);
      for (int i = 0; i < 16 && k + i < depth2; ++i)
        _mm512_storeu_si512(panel + ((k + i) * wide + c) * 2, block[i]);
    }
}

// x (rows, 2 depth2) transposed, as the factor of a sum over its width: `columns` >= rows.
inline void pack_transposed(const std::uint16_t* x, std::int64_t stride, std::int64_t rows,
                            std::int64_t depth2, std::int64_t columns, std::uint16_t* packed) {
  for (std::int64_t first = 0; first < columns; first += kPanel) {
    const std::int64_t wide = columns - first < kPanel ? columns - first : kPanel;
    const auto column = [&](std::int64_t c, std::int64_t k) {
      const __mmask16 lanes = first + c < rows ? first_lanes(depth2 - k) : 0;
      fetch(x + (first + c + 2 * kLanes) * stride + 2 * k, 1);
      return _mm512_maskz_loadu_epi32(lanes, x + (first + c) * stride + 2 * k);
    };
    pack_columns(wide, depth2, column, packed + first * 2 * depth2);
  }
}

}  // namespace
}  // namespace mocaplm::cpu
