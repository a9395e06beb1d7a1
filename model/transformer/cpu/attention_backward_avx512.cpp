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
// along the positions.
struct Room {
  explicit Room(const Sizes& n)
      : all(n.padded * n.width),
        all_wide(n.padded * n.wide),
        scratch(2 * Scratch::bytes(all, 2) + 3 * Scratch::bytes(all_wide, 2) +
                Scratch::bytes(all_wide, 4) + 3 * Scratch::bytes(n.padded, 4) +
                2 * Scratch::bytes(kBlock, 4) + 3 * Scratch::bytes(kBlock, 2) +
                2 * Scratch::bytes(kPanel * n.wide, 4)),
        q_across(scratch.halves(all)),
        dout_across(scratch.halves(all)),
        q_down(scratch.halves(all_wide)),
        dout_down(scratch.halves(all_wide)),
        k_down(scratch.halves(all_wide)),
        dq(scratch.floats(all_wide)),
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
  bf16 *q_across, *dout_across;       // panels of 64 queries
  bf16 *q_down, *dout_down, *k_down;  // blocks of 64 positions
  float* dq;                          // (padded, wide)
  float *log_sum, *delta;             // (padded); in powers of two; delta: sum of dout times out
  std::uint32_t* seeds;               // (padded), of the dropout
  float *scores, *dweights;           // (64, 64): keys by queries
  bf16 *weights, *dscores;            // (64, 64)
  bf16* dscores_down;                 // pairs of keys
  float *dk, *dv;                     // (64, wide)
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
      const auto down = [&](const bf16* x, std::int64_t stride, bf16* to) {
        pack_rows(x + t * stride, stride, rows, n.width, kPanel / 2, n.wide, to + t * n.wide);
      };
      down(q, n.stride, room.q_down);
      down(k, n.stride, room.k_down);
      down(dout, n.out_stride, room.dout_down);
    }
    zero(room.dq, room.all_wide);
    zero(room.log_sum, n.padded);
    zero(room.delta, n.padded);
    zero(room.seeds, n.padded);
    for (std::int64_t t = 0; t < n.length; ++t) {
      room.log_sum[t] = log_sum[t] * kLog2E;
      room.delta[t] = dot(dout + t * n.out_stride, out + t * n.out_stride, n.width);
      if (dropout.on) room.seeds[t] = row_seed(seed, pair, t);
    }
  }

  template <class Value>
  static void zero(Value* values, std::int64_t count) {
    std::memset(values, 0, static_cast<std::size_t>(count) * sizeof(Value));
  }

  // Weight (after dropout) and score gradient (before the scale) of key s for 16 queries from t on;
  // their scores are at `at` of the block. With All, every one of them sees the key.
  struct Lane {
    __m512 weight, dscore;
  };
  // What it reads, from query t on: by value, since what is stored might alter the members.
  struct Slices {
    const float *scores, *dweights, *log_sum, *delta;
    const std::uint32_t* seeds;  // null without dropout
  };
  template <bool All>
  Lane lane(const Slices& in, __m512 step, std::int64_t s, std::int64_t t, std::int64_t c,
            std::int64_t at) const {
    const __m512 x =
        _mm512_fmsub_ps(_mm512_loadu_ps(in.scores + at), step, _mm512_loadu_ps(in.log_sum + c));
    __m512 p = rough_power_of_two(x);
    if (!All) p = _mm512_maskz_mov_ps(seen(s, counting(t + c)), p);
    __m512 dp = _mm512_loadu_ps(in.dweights + at), used = p;
    if (in.seeds != nullptr) {
      const __m512 factor =
          dropout.factor(_mm512_loadu_si512(in.seeds + c), _mm512_set1_epi32(static_cast<int>(s)));
      dp = _mm512_mul_ps(dp, factor);
      used = _mm512_mul_ps(p, factor);
    }
    return {used, _mm512_mul_ps(p, _mm512_sub_ps(dp, _mm512_loadu_ps(in.delta + c)))};
  }
  __mmask16 seen(std::int64_t s, __m512i query) const {
    return (_mm512_cmpge_epi32_mask(query, _mm512_set1_epi32(static_cast<int>(s))) |
            _mm512_cmpge_epi32_mask(query, _mm512_set1_epi32(static_cast<int>(n.first_free)))) &
           _mm512_cmplt_epi32_mask(query, _mm512_set1_epi32(static_cast<int>(n.length)));
  }

  // Turns the block's scores and weight gradients into weights and score gradients.
  template <bool All>
  void differentiate(std::int64_t s, std::int64_t keys, std::int64_t t) const {
    const Lane nothing{_mm512_setzero_ps(), _mm512_setzero_ps()};
    const Slices in{room.scores, room.dweights, room.log_sum + t, room.delta + t,
                    dropout.on ? room.seeds + t : nullptr};
    const __m512 step = _mm512_set1_ps(n.scale * kLog2E);
    bf16 *weights = room.weights, *dscores = room.dscores, *down = room.dscores_down;
    for (std::int64_t row = 0; row < kPanel; row += 2, weights += kPanel, dscores += kPanel)
      for (std::int64_t c = 0; c < kPanel; c += kLanes, weights += kLanes, dscores += kLanes) {
        const std::int64_t at = row * kPanel + c;
        const Lane one = row < keys ? lane<All>(in, step, s + row, t, c, at) : nothing;
        const Lane two =
            row + 1 < keys ? lane<All>(in, step, s + row + 1, t, c, at + kPanel) : nothing;
        const __m512i slopes = to_bf16(one.dscore, two.dscore);
        store(weights, to_bf16(one.weight, two.weight));
        store(dscores, slopes);
        _mm512_storeu_si512(down, interleaved(slopes));
        down += 2 * kLanes;
      }
  }
  // The halves of x into a row and the next.
  static void store(bf16* to, __m512i x) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm512_castsi512_si256(x));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + kPanel), _mm512_extracti64x4_epi64(x, 1));
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
      product({k + s * n.stride, n.stride, 2}, keys,
              {room.q_across + t * n.width, half, kPanel, half}, room.scores, kPanel, false);
      product({v + s * n.stride, n.stride, 2}, keys,
              {room.dout_across + t * n.width, half, kPanel, half}, room.dweights, kPanel, false);
      if (t > s && t + kPanel <= n.length)
        differentiate<true>(s, kPanel, t);
      else
        differentiate<false>(s, keys, t);
      product({room.weights, kPanel, 2}, keys, {room.dout_down + t * n.wide, pairs, n.wide, pairs},
              room.dv, n.wide, true);
      product({room.dscores, kPanel, 2}, keys, {room.q_down + t * n.wide, pairs, n.wide, pairs},
              room.dk, n.wide, true);
      product({room.dscores_down, 2, 2 * kPanel}, end - t,
              {room.k_down + s * n.wide, pairs, n.wide, pairs}, room.dq + t * n.wide, n.wide, true);
    }
    for (std::int64_t row = 0; row < keys; ++row) {
      store_row(room.dk + row * n.wide, _mm512_set1_ps(n.scale), n.width,
                dk + (s + row) * n.stride);
      store_row(room.dv + row * n.wide, _mm512_set1_ps(1), n.width, dv + (s + row) * n.stride);
    }
  }

  void write_dq() const {
    for (std::int64_t t = 0; t < n.length; ++t)
      store_row(room.dq + t * n.wide, _mm512_set1_ps(n.scale), n.width, dq + t * n.stride);
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
