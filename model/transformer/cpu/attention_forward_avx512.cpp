#include "model/transformer/cpu/attention_avx512.h"
#include "model/transformer/cpu/attention_parts_avx512.h"

namespace mocaplm::cpu::avx512 {

namespace {

constexpr std::int64_t kQueries = 48;  // of a block

// The largest of n scores is the largest lane of this.
__m512 highest(const float* scores, std::int64_t n) {
  __m512 top[4];
  for (__m512& one : top) one = _mm512_set1_ps(-INFINITY);
  std::int64_t c = 0;
  for (; c + 4 * kLanes <= n; c += 4 * kLanes)
    for (int i = 0; i < 4; ++i)
      top[i] = _mm512_max_ps(top[i], _mm512_loadu_ps(scores + c + i * kLanes));
  for (; c < n; c += kLanes)
    top[0] = _mm512_mask_max_ps(top[0], first_lanes(n - c), top[0], _mm512_loadu_ps(scores + c));
  return _mm512_max_ps(_mm512_max_ps(top[0], top[1]), _mm512_max_ps(top[2], top[3]));
}

// Weights exp(scale (score - top)) of a row's first n scores in bf16, 0 up to `columns`; their sum.
// Dropout acts after the sum.
struct RowSum {
  float top, sum;
};
template <bool Drops>
RowSum softmax_row(const float* scores, std::int64_t n, std::int64_t columns, float scale,
                   const Dropout& dropout, std::uint32_t seed, bf16* weights) {
  const float most = _mm512_reduce_max_ps(highest(scores, n));
  // 2^(step score - shift) is e^(scale (score - most))
  const __m512 step = _mm512_set1_ps(scale * kLog2E), shift = _mm512_set1_ps(scale * kLog2E * most);
  const __m512i seeds = _mm512_set1_epi32(static_cast<int>(seed));
  const auto weight = [&](std::int64_t c) {
    return rough_power_of_two(_mm512_fmsub_ps(_mm512_loadu_ps(scores + c), step, shift));
  };
  const auto dropped = [&](std::int64_t c, __m512 x) {
    return Drops ? _mm512_mul_ps(x, dropout.factor(seeds, counting(c))) : x;
  };
  __m512 sum = _mm512_setzero_ps(), other = _mm512_setzero_ps();
  std::int64_t c = 0;
  for (; c + 2 * kLanes <= n; c += 2 * kLanes) {
    const __m512 one = weight(c), two = weight(c + kLanes);
    sum = _mm512_add_ps(sum, one);
    other = _mm512_add_ps(other, two);
    _mm512_storeu_si512(weights + c, to_bf16(dropped(c, one), dropped(c + kLanes, two)));
  }
  for (; c < n; c += kLanes) {
    const __m512 x = _mm512_maskz_mov_ps(first_lanes(n - c), weight(c));
    sum = _mm512_add_ps(sum, x);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(weights + c), to_bf16(dropped(c, x)));
  }
  for (; c < columns; c += kLanes)
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(weights + c), _mm256_setzero_si256());
  return {most, _mm512_reduce_add_ps(_mm512_add_ps(sum, other))};
}

}  // namespace

void attention_forward(const AttentionShape& shape, const bf16* qkv, bf16* out, float* log_sum,
                       std::int64_t first, std::int64_t last) {
  const Sizes n(shape);
  const Dropout dropout(shape.dropout);
  const auto softmax = dropout.on ? softmax_row<true> : softmax_row<false>;
  const std::int64_t row = n.padded + kLanes;  // no power of two: rows would share cache sets
  Scratch scratch(Scratch::bytes(n.padded * n.width, 2) + Scratch::bytes(n.padded * n.wide, 2) +
                  Scratch::bytes(kQueries * row, 4) + Scratch::bytes(kQueries * row, 2) +
                  Scratch::bytes(kQueries * n.wide, 4));
  bf16* keys = scratch.halves(n.padded * n.width);
  bf16* values = scratch.halves(n.padded * n.wide);
  float* scores = scratch.floats(kQueries * row);
  bf16* weights = scratch.halves(kQueries * row);
  float* sums = scratch.floats(kQueries * n.wide);
  for (std::int64_t pair = first; pair < last; ++pair) {
    const std::int64_t b = pair / shape.heads, h = pair % shape.heads;
    const bf16* q = qkv + b * n.length * n.stride + h * n.width;
    bf16* to = out + b * n.length * n.out_stride + h * n.width;
    pack_transposed(q + n.out_stride, n.stride, n.length, n.width / 2, n.padded, keys);
    pack_rows(q + 2 * n.out_stride, n.stride, n.length, n.width, n.padded / 2, n.wide, values);
    for (std::int64_t t = 0; t < n.length; t += kQueries) {
      const std::int64_t count = n.length - t < kQueries ? n.length - t : kQueries;
      const std::int64_t columns = round_up(n.limit(t + count - 1), kPanel);
      product({q + t * n.stride, n.stride, 2}, count, {keys, n.width / 2, columns, n.width / 2},
              scores, row, false);
      float rest[kQueries];
      for (std::int64_t r = 0; r < count; ++r) {
        const RowSum sum = softmax(scores + r * row, n.limit(t + r), columns, n.scale, dropout,
                                   row_seed(shape.seed, pair, t + r), weights + r * row);
        rest[r] = 1 / sum.sum;
        log_sum[pair * n.length + t + r] = sum.top * n.scale + std::log(sum.sum);
      }
      product({weights, row, 2}, count,
              {values, n.padded / 2, n.wide, (n.limit(t + count - 1) + 1) / 2}, sums, n.wide,
              false);
      for (std::int64_t r = 0; r < count; ++r)
        store_row(sums + r * n.wide, _mm512_set1_ps(rest[r]), n.width, to + (t + r) * n.out_stride);
    }
  }
}

}  // namespace mocaplm::cpu::avx512
