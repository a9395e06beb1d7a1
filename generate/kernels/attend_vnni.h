// Attention over a cache of 8-bit numbers by VNNI, for the two files that are compiled with it.
#pragma once

#include "generate/kernels/vnni.h"

namespace mocaplm {
namespace {

// Scores of one block of 16 positions. The query is x + 128 (unsigned), whose share is the head's
// key_offset. Four sums take turns, for a sum waits for the one before; the keys are read in order.
inline void score_bytes(const std::uint8_t* query, float query_scale, const ByteHead& head,
                        std::int64_t block, std::int64_t words, float* scores, Ahead& ahead) {
  __m512i sum[4];
  for (__m512i& one : sum) one = _mm512_setzero_si512();
  const std::uint32_t* keys = head.keys + block * words * kLanes;
  const auto step = [&](std::int64_t d, __m512i& to) {
    std::int32_t four;
    std::memcpy(&four, query + 4 * d, sizeof four);
    _mm_prefetch(reinterpret_cast<const char*>(keys + d * kLanes) + kAhead, _MM_HINT_T0);
    to = _mm512_dpbusd_epi32(to, _mm512_set1_epi32(four), _mm512_loadu_si512(keys + d * kLanes));
  };
  std::int64_t d = 0;
  ask(ahead, 2);  // of the numbers of each position
  for (; d + 4 <= words; d += 4) {
    ask(ahead, 4);
    for (int i = 0; i < 4; ++i) step(d + i, sum[i]);
  }
  for (; d < words; ++d) step(d, sum[0]);
  const __m512i all =
      _mm512_add_epi32(_mm512_add_epi32(sum[0], sum[1]), _mm512_add_epi32(sum[2], sum[3]));
  const std::int64_t at = block * kLanes;
  const __m512i exact = _mm512_sub_epi32(all, _mm512_loadu_si512(head.key_offset + at));
  const __m512 scale =
      _mm512_mul_ps(_mm512_loadu_ps(head.key_scale + at), _mm512_set1_ps(query_scale));
  _mm512_storeu_ps(scores + at, _mm512_mul_ps(_mm512_cvtepi32_ps(exact), scale));
}

// Adds what one block of 16 positions gives to 16 * Vectors columns. The weights of a block are
// brought to 0 .. 255 together.
template <int Vectors>
inline void add_block(const std::uint8_t* weights, float scale, const std::uint32_t* values,
                      std::int64_t padded, __m512* sums, Ahead& ahead) {
  __m512i sum[Vectors];
  for (int v = 0; v < Vectors; ++v) sum[v] = _mm512_setzero_si512();
  for (int quad = 0; quad < 4; ++quad) {
    ask(ahead, Vectors);
    std::int32_t four;
    std::memcpy(&four, weights + 4 * quad, sizeof four);
    const __m512i left = _mm512_set1_epi32(four);
    for (int v = 0; v < Vectors; ++v) {
      const std::uint32_t* from = values + quad * padded + v * 16;
      _mm_prefetch(reinterpret_cast<const char*>(from) + kAhead, _MM_HINT_T0);
      sum[v] = _mm512_dpbusd_epi32(sum[v], left, _mm512_loadu_si512(from));
    }
  }
  for (int v = 0; v < Vectors; ++v)
    sums[v] = _mm512_fmadd_ps(_mm512_cvtepi32_ps(sum[v]), _mm512_set1_ps(scale), sums[v]);
}

template <int Vectors>
inline void sum_bytes(const std::uint8_t* weights, const float* block_scale,
                      const std::uint32_t* values, std::int64_t blocks, std::int64_t padded,
                      float scale, float* out, Ahead& ahead) {
  __m512 sums[Vectors];
  for (int v = 0; v < Vectors; ++v) sums[v] = _mm512_setzero_ps();
  Ahead next = ahead;
  for (std::int64_t b = 0; b < blocks; ++b)
    add_block<Vectors>(weights + b * kLanes, block_scale[b], values + b * 4 * padded, padded, sums,
                       next);
  ahead = next;
  for (int v = 0; v < Vectors; ++v)
    _mm512_storeu_ps(out + v * 16, _mm512_mul_ps(sums[v], _mm512_set1_ps(scale)));
}

// Weights times the values' scales as bytes, 16 a block, over the scores that they come from; a
// scale a block.
inline void weigh(float* scores, const float* value_scale, std::int64_t blocks, float* block_scale,
                  Ahead& ahead) {
  auto* bytes = reinterpret_cast<std::uint8_t*>(scores);
  for (std::int64_t b = 0; b < blocks; ++b) {
    ask(ahead, 1);
    const __m512 weight = _mm512_mul_ps(_mm512_loadu_ps(scores + b * kLanes),
                                        _mm512_loadu_ps(value_scale + b * kLanes));
    const float top = _mm512_reduce_max_ps(weight);
    block_scale[b] = top / 255;
    const __m512 scaled = _mm512_mul_ps(weight, _mm512_set1_ps(top > 0 ? 255 / top : 0));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(bytes + b * kLanes),
                     _mm512_cvtusepi32_epi8(_mm512_cvtps_epi32(scaled)));
  }
}

void attend_vnni(const float* query, const ByteHead& head, std::int64_t count, std::int64_t width,
                 float* scores, float* out, Ahead& ahead) {
  const std::int64_t words = (width + 3) / 4, blocks = whole_lanes(count) / kLanes;
  float* block_scale = scores + blocks * kLanes;  // the second half of the scratch
  auto* bytes = reinterpret_cast<std::uint8_t*>(block_scale);
  float query_scale;
  prepare_vnni(query, 1, width, words, bytes, &query_scale);
  Ahead next = ahead;
  for (std::int64_t b = 0; b < blocks; ++b)
    score_bytes(bytes, query_scale, head, b, words, scores, next);
  const float scale = softmax(scores, count);
  weigh(scores, head.value_scale, blocks, block_scale, next);
  const auto* weights = reinterpret_cast<const std::uint8_t*>(scores);
  const std::int64_t padded = whole_lanes(width);
  for (std::int64_t c = 0; c < padded;) {
    alignas(64) float sums[64];
    const std::int64_t vectors = padded - c >= 64 ? 4 : padded - c >= 32 ? 2 : 1;
    const auto sum = vectors == 4 ? sum_bytes<4> : vectors == 2 ? sum_bytes<2> : sum_bytes<1>;
    sum(weights, block_scale, head.values + c, blocks, padded, scale, sums, next);
    for (std::int64_t j = 0; j < vectors * 16 && c + j < width; ++j) out[c + j] = sums[j];
    c += vectors * 16;
  }
  ahead = next;
}

// 16 values of x (count) from i as bytes in units of 1 / inverse, in 32-bit lanes; zeros past the
// end.
inline __m512i bytes_of(const float* x, std::int64_t i, std::int64_t count, float inverse) {
  const auto mask = static_cast<__mmask16>(count - i >= 16 ? 0xffff : (1 << (count - i)) - 1);
  return _mm512_cvtps_epi32(
      _mm512_mul_ps(_mm512_maskz_loadu_ps(mask, x + i), _mm512_set1_ps(inverse)));
}

void put_vnni(const float* key, const float* value, std::int64_t width, std::int64_t position,
              const ByteHead& head) {
  const float key_top = largest_size(key, width), value_top = largest_size(value, width);
  head.key_scale[position] = key_top / 127;
  head.value_scale[position] = value_top / 127;
  const float to_key = key_top > 0 ? 127 / key_top : 0,
              to_value = value_top > 0 ? 127 / value_top : 0;
  const std::int64_t words = (width + 3) / 4, padded = whole_lanes(width);
  std::uint32_t* keys = head.keys + position / kLanes * words * kLanes + position % kLanes;
  std::uint32_t* values = head.values + position / 4 * padded;
  const auto lane = static_cast<unsigned>(position % 4);
  const auto byte_mask = static_cast<__mmask64>(0x1111111111111111ULL << lane);
  __m512i sum = _mm512_setzero_si512();
  for (std::int64_t i = 0; i < width; i += 16) {
    const __m512i bytes = bytes_of(key, i, width, to_key);
    sum = _mm512_add_epi32(sum, bytes);
    std::uint32_t four[4];
    _mm_storeu_si128(reinterpret_cast<__m128i*>(four), _mm512_cvtepi32_epi8(bytes));
    for (std::int64_t w = 0; w < 4 && i / 4 + w < words; ++w) keys[(i / 4 + w) * kLanes] = four[w];
    const __m512i moved = _mm512_sllv_epi32(bytes_of(value, i, width, to_value),
                                            _mm512_set1_epi32(static_cast<int>(8 * lane)));
    _mm512_storeu_si512(values + i,
                        _mm512_mask_blend_epi8(byte_mask, _mm512_loadu_si512(values + i), moved));
  }
  head.key_offset[position] = kOffset * _mm512_reduce_add_epi32(sum);
}

}  // namespace
}  // namespace mocaplm
