#include <cstring>

#include "model/transformer/cpu/attention_avx512.h"
#include "model/transformer/cpu/attention_parts_avx512.h"

namespace mocaplm::cpu::avx512 {

namespace {

constexpr std::int64_t kBlock = kPanel * kPanel;

// The product of two rows in bf16.
float dot(const bf16* a, const bf16* b, std::int64_t width) {
  __m512 sum = _mm512_setzero_ps();
  for (std::int64_t c = 0; c < width; c += kLanes) {
    const __mmask16 lanes = first_lanes(width - c);
    sum = _mm512_fmadd_ps(to_f32(_mm256_maskz_loadu_epi16(lanes, a + c)),
                          to_f32(_mm256_maskz_loadu_epi16(lanes, b + c)), sum);
  }
  return _mm512_reduce_add_ps(sum);
}

// Room for one head at a time. Names: `across` is packed for sums along the width, `down` for sums
// along the positions, `turned` is transposed.
struct Room {
  explicit Room(const Sizes& n)
      : all(n.padded * n.width),
        all_wide(n.padded * n.wide),
        scratch(3 * Scratch::bytes(all, 2) + 2 * Scratch::bytes(all_wide, 2) +
                Scratch::bytes(all, 4) + 3 * Scratch::bytes(n.padded, 4) +
                2 * Scratch::bytes(kBlock, 4) + 3 * Scratch::bytes(kBlock, 2) +
                2 * Scratch::bytes(kPanel * n.wide, 4)),
        q_across(scratch.halves(all)),
        dout_across(scratch.halves(all)),
        k_turned(scratch.halves(all)),
        q_down(scratch.halves(all_wide)),
        dout_down(scratch.halves(all_wide)),
        dq_turned(scratch.floats(all)),
        log_sum(scratch.floats(n.padded)),
        delta(scratch.floats(n.padded)),
        seeds(scratch.words(n.padded)),
        scores(scratch.floats(kBlock)),
        dweights(scratch.floats(kBlock)),
        weights(scratch.halves(kBlock)),
        dscores(scratch.halves(kBlock)),
        dscores_down(scratch.halves(kBlock)),
        dk(scratch.floats(kPanel * n.wide)),
        dv(scratch.floats(kPanel * n.wide)) {}

  std::int64_t all, all_wide;
  Scratch scratch;
  bf16 *q_across, *dout_across;  // panels of 64 queries
  bf16* k_turned;                // (D, padded)
  bf16 *q_down, *dout_down;      // blocks of 64 queries
  float* dq_turned;              // [panel](D, 64)
  float *log_sum, *delta;        // (padded); delta: sum of dout times out
  std::uint32_t* seeds;          // (padded), of the dropout
  float *scores, *dweights;      // (64, 64): keys by queries
  bf16 *weights, *dscores;       // (64, 64)
  bf16* dscores_down;
  float *dk, *dv;  // (64, wide)
};

// One head of one batch element.
struct Head {
  const Sizes& n;
  const Dropout& dropout;
  const Room& room;
  const bf16 *q, *k, *v, *out, *dout;
  bf16 *dq, *dk, *dv;

  void prepare(const float* log_sum, std::uint64_t seed, std::int64_t pair) const {
    pack_transposed(q, n.stride, n.length, n.width / 2, n.padded, room.q_across);
    pack_transposed(dout, n.out_stride, n.length, n.width / 2, n.padded, room.dout_across);
    for (std::int64_t t = 0; t < n.length; t += kPanel) {
      const std::int64_t rows = n.length - t < kPanel ? n.length - t : kPanel;
      pack_rows(q + t * n.stride, n.stride, rows, n.width, kPanel / 2, n.wide,
                room.q_down + t * n.wide);
      pack_rows(dout + t * n.out_stride, n.out_stride, rows, n.width, kPanel / 2, n.wide,
                room.dout_down + t * n.wide);
    }
    zero(room.k_turned, room.all);
    zero(room.dq_turned, room.all);
    zero(room.log_sum, n.padded);
    zero(room.delta, n.padded);
    zero(room.seeds, n.padded);
    for (std::int64_t t = 0; t < n.length; ++t) {
      for (std::int64_t c = 0; c < n.width; ++c)
        room.k_turned[c * n.padded + t] = k[t * n.stride + c];
      room.log_sum[t] = log_sum[t];
      room.delta[t] = dot(dout + t * n.out_stride, out + t * n.out_stride, n.width);
      room.seeds[t] = row_seed(seed, pair, t);
    }
  }

  template <class Value>
  static void zero(Value* values, std::int64_t count) {
    std::memset(values, 0, static_cast<std::size_t>(count) * sizeof(Value));
  }

  // Weight (after dropout) and score gradient of key s for 16 queries from t on; their scores are
  // at `at` of the block.
  struct Lane {
    __m512 weight, dscore;
  };
  Lane lane(std::int64_t s, std::int64_t t, std::int64_t at) const {
    const __m512i query = counting(t);
    const __mmask16 seen =
        (_mm512_cmpge_epi32_mask(query, _mm512_set1_epi32(static_cast<int>(s))) |
         _mm512_cmpge_epi32_mask(query, _mm512_set1_epi32(static_cast<int>(n.first_free)))) &
        _mm512_cmplt_epi32_mask(query, _mm512_set1_epi32(static_cast<int>(n.length)));
    const __m512 scale = _mm512_set1_ps(n.scale);
    const __m512 x = _mm512_fmsub_ps(_mm512_loadu_ps(room.scores + at), scale,
                                     _mm512_loadu_ps(room.log_sum + t));
    const __m512 p = _mm512_maskz_mov_ps(seen, exponential(x));
    __m512 dp = _mm512_loadu_ps(room.dweights + at), used = p;
    if (dropout.on) {
      const __m512 factor = dropout.factor(_mm512_loadu_si512(room.seeds + t),
                                           _mm512_set1_epi32(static_cast<int>(s)));
      dp = _mm512_mul_ps(dp, factor);
      used = _mm512_mul_ps(p, factor);
    }
    const __m512 rest = _mm512_sub_ps(dp, _mm512_loadu_ps(room.delta + t));
    return {used, _mm512_maskz_mul_ps(seen, _mm512_mul_ps(p, rest), scale)};
  }

  // Turns the block's scores and weight gradients into weights and score gradients.
  void differentiate(std::int64_t s, std::int64_t keys, std::int64_t t) const {
    const Lane nothing{_mm512_setzero_ps(), _mm512_setzero_ps()};
    for (std::int64_t row = 0; row < kPanel; row += 2)
      for (std::int64_t c = 0; c < kPanel; c += kLanes) {
        const std::int64_t one_at = row * kPanel + c, two_at = one_at + kPanel;
        const Lane one = row < keys ? lane(s + row, t + c, one_at) : nothing;
        const Lane two = row + 1 < keys ? lane(s + row + 1, t + c, two_at) : nothing;
        store(room.weights + one_at, one.weight);
        store(room.weights + two_at, two.weight);
        store(room.dscores + one_at, one.dscore);
        store(room.dscores + two_at, two.dscore);
        _mm512_storeu_si512(room.dscores_down + (row / 2 * kPanel + c) * 2,
                            interleaved(one.dscore, two.dscore));
      }
  }
  static void store(bf16* to, __m512 x) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), to_bf16(x));
  }

  // Up to 64 keys from s on, against all queries that see any of them.
  void key_block(std::int64_t s) const {
    const std::int64_t keys = n.length - s < kPanel ? n.length - s : kPanel;
    const std::int64_t half = n.width / 2, pairs = kPanel / 2;
    zero(room.dk, kPanel * n.wide);
    zero(room.dv, kPanel * n.wide);
    for (std::int64_t t = 0; t < n.length; t += kPanel) {
      const std::int64_t end = t + kPanel < n.length ? t + kPanel : n.length;
      if (n.limit(end - 1) <= s) continue;
      product(k + s * n.stride, n.stride, keys, {room.q_across + t * n.width, half, kPanel, half},
              room.scores, kPanel, false);
      product(v + s * n.stride, n.stride, keys,
              {room.dout_across + t * n.width, half, kPanel, half}, room.dweights, kPanel, false);
      differentiate(s, keys, t);
      product(room.weights, kPanel, keys, {room.dout_down + t * n.wide, pairs, n.wide, pairs},
              room.dv, n.wide, true);
      product(room.dscores, kPanel, keys, {room.q_down + t * n.wide, pairs, n.wide, pairs}, room.dk,
              n.wide, true);
      product(room.k_turned + s, n.padded, n.width, {room.dscores_down, pairs, kPanel, pairs},
              room.dq_turned + t * n.width, kPanel, true);
    }
    for (std::int64_t row = 0; row < keys; ++row) {
      store_row(room.dk + row * n.wide, _mm512_set1_ps(1), n.width, dk + (s + row) * n.stride);
      store_row(room.dv + row * n.wide, _mm512_set1_ps(1), n.width, dv + (s + row) * n.stride);
    }
  }

  void write_dq() const {
    float row[kMaxWidth];
    for (std::int64_t t = 0; t < n.length; ++t) {
      const float* from = room.dq_turned + t / kPanel * kPanel * n.width + t % kPanel;
      for (std::int64_t c = 0; c < n.width; ++c) row[c] = from[c * kPanel];
      store_row(row, _mm512_set1_ps(1), n.width, dq + t * n.stride);
    }
  }
};

}  // namespace

void attention_backward(const AttentionShape& shape, const bf16* qkv, const bf16* out,
                        const float* log_sum, const bf16* dout, bf16* dqkv, std::int64_t first,
                        std::int64_t last) {
  const Sizes n(shape);
  const Dropout dropout(shape.dropout);
  const Room room(n);
  for (std::int64_t pair = first; pair < last; ++pair) {
    const std::int64_t b = pair / shape.heads, h = pair % shape.heads;
    const std::int64_t out_at = b * n.length * n.out_stride + h * n.width;
    const bf16* q = qkv + b * n.length * n.stride + h * n.width;
    bf16* dq = dqkv + (q - qkv);
    const Head head{n,
                    dropout,
                    room,
                    q,
                    q + n.out_stride,
                    q + 2 * n.out_stride,
                    out + out_at,
                    dout + out_at,
                    dq,
                    dq + n.out_stride,
                    dq + 2 * n.out_stride};
    head.prepare(log_sum + pair * n.length, shape.seed, pair);
    for (std::int64_t s = 0; s < n.length; s += kPanel) head.key_block(s);
    head.write_dq();
  }
}

}  // namespace mocaplm::cpu::avx512
