// The kernels for AVX-512 with VNNI and BF16, whose dot products take pairs of bf16.
#include "generate/kernels/attend_vnni.h"

namespace mocaplm {
namespace {

inline __m512bh pairs(const std::uint32_t* words) {
  return (__m512bh)_mm512_loadu_si512(words);
}

inline __m512bh same_pair(const void* word) {
  std::int32_t two;
  std::memcpy(&two, word, sizeof two);
  return (__m512bh)_mm512_set1_epi32(two);
}

// Values i .. i+31 of x (count) as 16 words of pairs, zeros past the end.
inline __m512i rounded(const float* x, std::int64_t i, std::int64_t count) {
  const std::int64_t left = count - i;
  const auto mask = [](std::int64_t n) {
    return static_cast<__mmask16>(n >= 16 ? 0xffff : n > 0 ? (1 << n) - 1 : 0);
  };
  return (__m512i)_mm512_cvtne2ps_pbh(_mm512_maskz_loadu_ps(mask(left - 16), x + i + 16),
                                      _mm512_maskz_loadu_ps(mask(left), x + i));
}

// Writes `words` words.
inline void round_row(const float* x, std::int64_t count, std::int64_t words, std::uint32_t* to) {
  for (std::int64_t w = 0; w < words; w += 16) {
    const std::int64_t left = words - w;
    const auto mask = static_cast<__mmask16>(left >= 16 ? 0xffff : (1 << left) - 1);
    _mm512_mask_storeu_epi32(to + w, mask, rounded(x, 2 * w, count));
  }
}

void prepare_pairs(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                   void* prepared) {
  for (std::int64_t r = 0; r < rows; ++r)
    round_row(x + r * in, in, depth, static_cast<std::uint32_t*>(prepared) + r * depth);
}

template <int Count>
inline void tile_pairs(const std::uint32_t* x, std::int64_t depth, const std::uint32_t* panel,
                       float* tile, Ahead& ahead, int lines) {
  constexpr int kVectors = kPanel / 16;
  __m512 sum[Count][kVectors];
  for (int r = 0; r < Count; ++r)
    for (int v = 0; v < kVectors; ++v) sum[r][v] = _mm512_setzero_ps();
  Ahead next = ahead;
  for (std::int64_t k = 0; k < depth; ++k) {
    ask(next, lines);
    __m512bh weights[kVectors];
    for (int v = 0; v < kVectors; ++v) weights[v] = pairs(panel + k * kPanel + v * 16);
    for (int r = 0; r < Count; ++r) {
      const __m512bh left = same_pair(x + r * depth + k);
      for (int v = 0; v < kVectors; ++v) sum[r][v] = _mm512_dpbf16_ps(sum[r][v], left, weights[v]);
    }
  }
  ahead = next;
  for (int r = 0; r < Count; ++r)
    for (int v = 0; v < kVectors; ++v) _mm512_storeu_ps(tile + r * kPanel + v * 16, sum[r][v]);
}

void product_pairs(const void* prepared, std::int64_t rows, std::int64_t depth,
                   const std::uint32_t* panel, float* tile, Ahead& ahead) {
  const auto* x = static_cast<const std::uint32_t*>(prepared);
  if (rows == 1) return tile_pairs<1>(x, depth, panel, tile, ahead, 4);
  in_tiles(rows, [&](auto size, std::int64_t r, int lines) {
    tile_pairs<decltype(size)::value>(x + r * depth, depth, panel, tile + r * kPanel, ahead, lines);
  });
}

// Scores of one block of 16 positions. Eight sums take turns, for a sum waits for the one before;
// the keys are read in order.
inline void score_block(const std::uint32_t* query, const std::uint32_t* keys, std::int64_t words,
                        float* scores, Ahead& ahead) {
  constexpr int kSums = 8;
  __m512 sum[kSums];
  for (__m512& one : sum) one = _mm512_setzero_ps();
  const auto step = [&](std::int64_t d, __m512& to) {
    _mm_prefetch(reinterpret_cast<const char*>(keys + d * kLanes) + kAhead, _MM_HINT_T0);
    to = _mm512_dpbf16_ps(to, same_pair(query + d), pairs(keys + d * kLanes));
  };
  std::int64_t d = 0;
  for (; d + kSums <= words; d += kSums) {
    ask(ahead, kSums);
    for (int i = 0; i < kSums; ++i) step(d + i, sum[i]);
  }
  for (; d < words; ++d) step(d, sum[0]);
  for (int half = kSums / 2; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) sum[i] = _mm512_add_ps(sum[i], sum[i + half]);
  _mm512_storeu_ps(scores, sum[0]);
}

// 16 * Vectors columns of the weighted sum of values; even and odd pairs of positions apart, for
// the same reason.
template <int Vectors>
inline void sum_values(const float* weights, const std::uint32_t* values, std::int64_t pair_count,
                       std::int64_t padded, float scale, float* sums, Ahead& ahead) {
  __m512 sum[2][Vectors];
  for (int v = 0; v < Vectors; ++v) sum[0][v] = sum[1][v] = _mm512_setzero_ps();
  Ahead next = ahead;
  for (std::int64_t t = 0; t < pair_count; t += 2) {  // whole blocks: an even number of pairs
    ask(next, 2 * Vectors);
    for (int half = 0; half < 2; ++half) {
      const __m512bh left = same_pair(weights + t + half);
      for (int v = 0; v < Vectors; ++v) {
        const std::uint32_t* from = values + (t + half) * padded + v * 16;
        _mm_prefetch(reinterpret_cast<const char*>(from) + kAhead, _MM_HINT_T0);
        sum[half][v] = _mm512_dpbf16_ps(sum[half][v], left, pairs(from));
      }
    }
  }
  ahead = next;
  const __m512 scales = _mm512_set1_ps(scale);
  for (int v = 0; v < Vectors; ++v)
    _mm512_storeu_ps(sums + v * 16, _mm512_mul_ps(_mm512_add_ps(sum[0][v], sum[1][v]), scales));
}

void attend_pairs(const float* query, const std::uint32_t* keys, const std::uint32_t* values,
                  std::int64_t count, std::int64_t width, float* scores, float* out, Ahead& ahead) {
  constexpr std::int64_t kChunk = 1024;  // values of a query that are rounded at a time
  const std::int64_t words = (width + 1) / 2, blocks = whole_lanes(count) / kLanes;
  std::uint32_t rounded_query[kChunk / 2];
  if (width > kChunk) return attend_bf16(query, keys, values, count, width, scores, out, ahead);
  round_row(query, width, words, rounded_query);
  for (std::int64_t b = 0; b < blocks; ++b)
    score_block(rounded_query, keys + b * words * kLanes, words, scores + b * kLanes, ahead);
  const float scale = softmax(scores, count);
  // Rounded in place: a word is written after the two values that it holds were read.
  for (std::int64_t t = 0; t < blocks; t += 2) {
    const __m512i both = rounded(scores, t * kLanes, blocks * kLanes);
    _mm512_mask_storeu_epi32(scores + t * kLanes / 2, t + 1 < blocks ? 0xffff : 0xff, both);
  }
  const std::int64_t pair_count = blocks * kLanes / 2;
  const std::int64_t padded = whole_lanes(width);
  for (std::int64_t c = 0; c < padded;) {
    alignas(64) float sums[64];
    const std::int64_t vectors = padded - c >= 64 ? 4 : padded - c >= 32 ? 2 : 1;
    if (vectors == 4)
      sum_values<4>(scores, values + c, pair_count, padded, scale, sums, ahead);
    else if (vectors == 2)
      sum_values<2>(scores, values + c, pair_count, padded, scale, sums, ahead);
    else
      sum_values<1>(scores, values + c, pair_count, padded, scale, sums, ahead);
    for (std::int64_t j = 0; j < vectors * 16 && c + j < width; ++j) out[c + j] = sums[j];
    c += vectors * 16;
  }
}

}  // namespace

const Kernels kAvx512Bf16Kernels = {
    product_f32, prepare_pairs, product_pairs, prepare_vnni, product_vnni, attend_f32, attend_pairs,
    attend_vnni, put_vnni,      layer_norm,    store,        store_gelu,   store_sum};

}  // namespace mocaplm
