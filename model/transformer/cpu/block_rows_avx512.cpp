// What a block does row by row.
#include <cmath>

#include "model/transformer/cpu/block_parts_avx512.h"

namespace mocaplm::cpu::avx512 {

void layer_norm(const float* x, std::int64_t width, const float* weight, const float* bias, bf16* y,
                float* stats, std::int64_t first, std::int64_t last) {
  const float share = 1 / static_cast<float>(width);
  for (std::int64_t r = first; r < last; ++r) {
    const float* row = x + r * width;
    __m512 sum = _mm512_setzero_ps(), square = _mm512_setzero_ps();
    for (std::int64_t c = 0; c < width; c += kLanes)
      sum = _mm512_add_ps(sum, _mm512_loadu_ps(row + c));
    const float mean = _mm512_reduce_add_ps(sum) * share;
    for (std::int64_t c = 0; c < width; c += kLanes) {
      const __m512 centred = _mm512_sub_ps(_mm512_loadu_ps(row + c), _mm512_set1_ps(mean));
      square = _mm512_fmadd_ps(centred, centred, square);
    }
    const float scale = 1 / std::sqrt(_mm512_reduce_add_ps(square) * share + 1e-5f);
    for (std::int64_t c = 0; c < width; c += kLanes) {
      const __m512 normal = _mm512_mul_ps(
          _mm512_sub_ps(_mm512_loadu_ps(row + c), _mm512_set1_ps(mean)), _mm512_set1_ps(scale));
      store_halves(y + r * width + c, 0xFFFF,
                   _mm512_fmadd_ps(normal, _mm512_loadu_ps(weight + c), _mm512_loadu_ps(bias + c)));
    }
    stats[2 * r] = mean;
    stats[2 * r + 1] = scale;
  }
}

void layer_norm_backward(const bf16* dy, const float* x, const float* stats, std::int64_t width,
                         const float* weight, const float* residual, float* dx, float* dweight,
                         float* dbias, std::int64_t first, std::int64_t last) {
  const float share = 1 / static_cast<float>(width);
  for (std::int64_t r = first; r < last; ++r) {
    const std::int64_t at = r * width;
    const __m512 mean = _mm512_set1_ps(stats[2 * r]), scale = _mm512_set1_ps(stats[2 * r + 1]);
    const auto normal = [&](std::int64_t c) {
      return _mm512_mul_ps(_mm512_sub_ps(_mm512_loadu_ps(x + at + c), mean), scale);
    };
    __m512 sum = _mm512_setzero_ps(), along = _mm512_setzero_ps();
    for (std::int64_t c = 0; c < width; c += kLanes) {
      const __m512 n = normal(c), d = load_halves(0xFFFF, dy + at + c);
      const __m512 g = _mm512_mul_ps(d, _mm512_loadu_ps(weight + c));
      sum = _mm512_add_ps(sum, g);
      along = _mm512_fmadd_ps(g, n, along);
      _mm512_storeu_ps(dweight + c, _mm512_fmadd_ps(d, n, _mm512_loadu_ps(dweight + c)));
      _mm512_storeu_ps(dbias + c, _mm512_add_ps(d, _mm512_loadu_ps(dbias + c)));
    }
    const __m512 level = _mm512_set1_ps(_mm512_reduce_add_ps(sum) * share),
                 slope = _mm512_set1_ps(_mm512_reduce_add_ps(along) * share);
    for (std::int64_t c = 0; c < width; c += kLanes) {
      const __m512 g = _mm512_mul_ps(load_halves(0xFFFF, dy + at + c), _mm512_loadu_ps(weight + c));
      const __m512 rest = _mm512_fnmadd_ps(normal(c), slope, _mm512_sub_ps(g, level));
      _mm512_storeu_ps(dx + at + c,
                       _mm512_fmadd_ps(rest, scale, _mm512_loadu_ps(residual + at + c)));
    }
  }
}

void to_halves(const float* x, std::int64_t columns, const DropoutMask& mask, bf16* y,
               std::int64_t stride, std::int64_t first, std::int64_t last) {
  const Dropping dropping(mask);
  for (std::int64_t r = first; r < last; ++r)
    for (std::int64_t c = 0; c < stride; c += kLanes) {
      const std::int64_t at = r * columns + c;
      __m512 value = _mm512_maskz_loadu_ps(first_lanes(columns - c), x + at);
      if (dropping.on) value = _mm512_mul_ps(value, dropping.factor(at));
      store_halves(y + r * stride + c, first_lanes(stride - c), value);
    }
}

float softmax(float* z, std::int64_t n) {
  __m512 most = _mm512_set1_ps(-INFINITY);
  for (std::int64_t c = 0; c < n; c += kLanes)
    most = _mm512_mask_max_ps(most, first_lanes(n - c), most,
                              _mm512_maskz_loadu_ps(first_lanes(n - c), z + c));
  const float top = _mm512_reduce_max_ps(most);
  const __m512 step = _mm512_set1_ps(kLog2E), shift = _mm512_set1_ps(top);
  __m512 sum = _mm512_setzero_ps();
  for (std::int64_t c = 0; c < n; c += kLanes) {
    const __mmask16 lanes = first_lanes(n - c);
    const __m512 x = _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, z + c), shift);
    const __m512 e = _mm512_maskz_mov_ps(lanes, power_of_two(_mm512_mul_ps(x, step)));
    _mm512_mask_storeu_ps(z + c, lanes, e);
    sum = _mm512_add_ps(sum, e);
  }
  const float total = _mm512_reduce_add_ps(sum);
  const __m512 share = _mm512_set1_ps(1 / total);
  for (std::int64_t c = 0; c < n; c += kLanes) {
    const __mmask16 lanes = first_lanes(n - c);
    _mm512_mask_storeu_ps(z + c, lanes, _mm512_mul_ps(_mm512_maskz_loadu_ps(lanes, z + c), share));
  }
  return top + std::log(total);
}

}  // namespace mocaplm::cpu::avx512
