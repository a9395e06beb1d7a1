#include "model/transformer/cpu/block_parts_avx512.h"

namespace mocaplm::cpu::avx512 {

namespace {

constexpr std::int64_t kTile = 6;  // rows at a time

// Hands every finished row of a strip, 16 columns at a time, to finish(row, column, lanes, sums),
// as soon as a tile of rows is done; before the tile, ahead(row, column, columns) may fetch what
// finish is going to touch.
template <class Ahead, class Finish>
void multiply(const Product& p, std::int64_t first, std::int64_t last, const Ahead& ahead,
              const Finish& finish) {
  alignas(64) float sums[kBlockRows * kPanel];
  for (std::int64_t begin = first; begin < last; begin += kBlockRows) {
    const std::int64_t rows = last - begin < kBlockRows ? last - begin : kBlockRows;
    for (std::int64_t column = 0; column < p.columns; column += kPanel) {
      const std::int64_t left = round_up(p.columns - column, kLanes);
      const std::int64_t wide = left < kPanel ? left : kPanel;
      const bf16* panel = p.weights + column * p.depth;
      for (std::int64_t k = 0; k < p.depth; k += kDepth) {
        const std::int64_t depth = p.depth - k < kDepth ? p.depth - k : kDepth;
        const bool done = k + depth == p.depth;
        for (std::int64_t r = 0; r < rows; r += kTile) {
          const std::int64_t some = rows - r < kTile ? rows - r : kTile;
          for (std::int64_t i = 0; done && i < some; ++i) ahead(begin + r + i, column, wide);
          panel_product({p.x + (begin + r) * p.depth + k, p.depth, 2}, some, wide, panel + k * wide,
                        depth / 2, sums + r * kPanel, kPanel, k > 0);
          for (std::int64_t i = r; done && i < r + some; ++i)
            for (std::int64_t c = 0; c < wide; c += kLanes)
              finish(begin + i, column + c, first_lanes(p.columns - column - c),
                     _mm512_load_ps(sums + i * kPanel + c));
        }
      }
    }
  }
}

// For `ahead`: the columns of one row of an array that is as wide as the product.
template <class Value>
void fetch_row(const Product& p, const Value* array, std::int64_t r, std::int64_t c,
               std::int64_t count) {
  fetch(array + r * p.columns + c, count * static_cast<std::int64_t>(sizeof(Value)));
}

__m512 biased(const float* bias, std::int64_t column, __mmask16 lanes, __m512 sum) {
  return bias == nullptr ? sum : _mm512_add_ps(sum, _mm512_maskz_loadu_ps(lanes, bias + column));
}

void linear(const Product& p, const float* bias, bf16* y, std::int64_t first, std::int64_t last) {
  const auto ahead = [&](std::int64_t r, std::int64_t c, std::int64_t count) {
    fetch_row(p, y, r, c, count);
  };
  multiply(p, first, last, ahead, [&](std::int64_t r, std::int64_t c, __mmask16 lanes, __m512 sum) {
    store_halves(y + r * p.columns + c, lanes, biased(bias, c, lanes, sum));
  });
}

void linear_f32(const Product& p, const float* bias, float* y, std::int64_t first,
                std::int64_t last) {
  const auto ahead = [&](std::int64_t r, std::int64_t c, std::int64_t count) {
    fetch_row(p, y, r, c, count);
  };
  multiply(p, first, last, ahead, [&](std::int64_t r, std::int64_t c, __mmask16 lanes, __m512 sum) {
    _mm512_mask_storeu_ps(y + r * p.columns + c, lanes, biased(bias, c, lanes, sum));
  });
}

// The normal distribution's integral up to x by formula 7.1.26 of Abramowitz and Stegun for the
// error function, and its density: to 1e-4, a twentieth of what rounding to bf16 may cost.
struct Normal {
  __m512 integral, density;
};
Normal normal(__m512 x) {
  const __m512 one = _mm512_set1_ps(1);
  const __m512 d = _mm512_fmadd_ps(_mm512_abs_ps(x), _mm512_set1_ps(0.3275911f * 0.70710678f), one);
  const __m512 t = _mm512_rcp14_ps(d);
  const __m512 e =
      rough_power_of_two(_mm512_mul_ps(_mm512_mul_ps(x, x), _mm512_set1_ps(-0.5f * kLog2E)));
  __m512 p = _mm512_set1_ps(0.5f * 1.061405429f);
  p = _mm512_fmadd_ps(p, t, _mm512_set1_ps(0.5f * -1.453152027f));
  p = _mm512_fmadd_ps(p, t, _mm512_set1_ps(0.5f * 1.421413741f));
  p = _mm512_fmadd_ps(p, t, _mm512_set1_ps(0.5f * -0.284496736f));
  p = _mm512_fmadd_ps(p, t, _mm512_set1_ps(0.5f * 0.254829592f));
  const __m512 tail = _mm512_mul_ps(_mm512_mul_ps(p, t), e);
  const __mmask16 negative = _mm512_cmplt_ps_mask(x, _mm512_setzero_ps());
  return {_mm512_mask_mov_ps(_mm512_sub_ps(one, tail), negative, tail),
          _mm512_mul_ps(e, _mm512_set1_ps(0.39894228f))};
}

void linear_gelu(const Product& p, const float* bias, bf16* y, bf16* slope, std::int64_t first,
                 std::int64_t last) {
  const auto ahead = [&](std::int64_t r, std::int64_t c, std::int64_t count) {
    fetch_row(p, y, r, c, count);
    if (slope != nullptr) fetch_row(p, slope, r, c, count);
  };
  multiply(p, first, last, ahead, [&](std::int64_t r, std::int64_t c, __mmask16 lanes, __m512 sum) {
    const __m512 x = biased(bias, c, lanes, sum);
    const Normal n = normal(x);
    store_halves(y + r * p.columns + c, lanes, _mm512_mul_ps(x, n.integral));
    if (slope != nullptr)
      store_halves(slope + r * p.columns + c, lanes, _mm512_fmadd_ps(x, n.density, n.integral));
  });
}

void linear_residual(const Product& p, const float* bias, const DropoutMask& mask, const float* x,
                     float* y, std::int64_t first, std::int64_t last) {
  const Dropping dropping(mask);
  const auto ahead = [&](std::int64_t r, std::int64_t c, std::int64_t count) {
    fetch_row(p, x, r, c, count);
    fetch_row(p, y, r, c, count);
  };
  multiply(p, first, last, ahead, [&](std::int64_t r, std::int64_t c, __mmask16 lanes, __m512 sum) {
    const std::int64_t at = r * p.columns + c;
    __m512 value = biased(bias, c, lanes, sum);
    if (dropping.on) value = _mm512_mul_ps(value, dropping.factor(at));
    _mm512_mask_storeu_ps(y + at, lanes,
                          _mm512_add_ps(value, _mm512_maskz_loadu_ps(lanes, x + at)));
  });
}

void linear_times(const Product& p, const bf16* factor, bf16* y, std::int64_t first,
                  std::int64_t last) {
  const auto ahead = [&](std::int64_t r, std::int64_t c, std::int64_t count) {
    fetch_row(p, factor, r, c, count);
    fetch_row(p, y, r, c, count);
  };
  multiply(p, first, last, ahead, [&](std::int64_t r, std::int64_t c, __mmask16 lanes, __m512 sum) {
    const std::int64_t at = r * p.columns + c;
    store_halves(y + at, lanes, _mm512_mul_ps(sum, load_halves(lanes, factor + at)));
  });
}

// Element (depth, column) of the factor is w[column][depth].
void pack_transposed(const float* w, std::int64_t rows, std::int64_t columns, bf16* packed,
                     std::int64_t first, std::int64_t last) {
  for (std::int64_t panel = first; panel < last; ++panel) {
    const std::int64_t begin = panel * kPanel, left = round_up(rows - begin, kLanes);
    const std::int64_t wide = left < kPanel ? left : kPanel;
    bf16* to = packed + begin * columns;
    const auto column = [&](std::int64_t c, std::int64_t k) {
      const float* from = w + (begin + c) * columns + 2 * k;
      const std::int64_t there = begin + c < rows ? columns - 2 * k : 0;
      return to_bf16(_mm512_maskz_loadu_ps(first_lanes(there), from),
                     _mm512_maskz_loadu_ps(first_lanes(there - kLanes), from + kLanes));
    };
    pack_columns(wide, columns / 2, column, to);
  }
}

// Element (depth, column) of the factor is w[depth][column]; an odd last row is paired with zeros.
void pack(const float* w, std::int64_t rows, std::int64_t columns, bf16* packed, std::int64_t first,
          std::int64_t last) {
  const std::int64_t depth = round_up(rows, 2);
  for (std::int64_t panel = first; panel < last; ++panel) {
    const std::int64_t begin = panel * kPanel, left = round_up(columns - begin, kLanes);
    const std::int64_t wide = left < kPanel ? left : kPanel;
    bf16* to = packed + begin * depth;
    for (std::int64_t k = 0; k < depth; k += 2)
      for (std::int64_t c = 0; c < wide; c += kLanes) {
        const __mmask16 lanes = first_lanes(columns - begin - c);
        const float* from = w + k * columns + begin + c;
        _mm512_storeu_si512(
            to + (k / 2 * wide + c) * 2,
            interleaved(to_bf16(_mm512_maskz_loadu_ps(lanes, from),
                                _mm512_maskz_loadu_ps(k + 1 < rows ? lanes : 0, from + columns))));
      }
  }
}

}  // namespace

const BlockKernels kBlockKernels = {pack_transposed, pack,        linear,
                                    linear_f32,      linear_gelu, linear_residual,
                                    linear_times,    layer_norm,  layer_norm_backward,
                                    to_halves,       softmax,     weight_gradient};

}  // namespace mocaplm::cpu::avx512
