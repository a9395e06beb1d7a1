#include "generate/kernels.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace mocaplm {

namespace {

// The bodies are plain loops that the compiler turns into the instructions of the function they are
// inlined in; the three wrappers below differ in nothing but that target.
#define MOCAPLM_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__)
#define MOCAPLM_AVX2 __attribute__((target("avx2,fma")))
#define MOCAPLM_AVX512 \
  __attribute__((target("avx512f,avx512vl,avx512bw,avx512dq,avx2,fma,prefer-vector-width=512")))
#else
#define MOCAPLM_AVX2
#define MOCAPLM_AVX512
#endif

constexpr std::int64_t kWide = PackedLinear::kPanel;

// Rows r .. r+Rows of x times one panel: Rows * kWide accumulators stay in registers.
template <int Rows>
MOCAPLM_INLINE void panel_rows(const float* x, const float* panel, const float* bias,
                               std::int64_t in, float* y, std::int64_t out_stride,
                               std::int64_t columns) {
  float sums[Rows][kWide];
  for (int r = 0; r < Rows; ++r)
    for (int j = 0; j < kWide; ++j) sums[r][j] = bias[j];
  for (std::int64_t k = 0; k < in; ++k) {
    const float* weights = panel + k * kWide;
    for (int r = 0; r < Rows; ++r) {
      const float value = x[r * in + k];
      for (int j = 0; j < kWide; ++j) sums[r][j] += value * weights[j];
    }
  }
  for (int r = 0; r < Rows; ++r)
    std::memcpy(y + r * out_stride, sums[r], sizeof(float) * static_cast<std::size_t>(columns));
}

MOCAPLM_INLINE void panel_body(const float* x, const float* panel, const float* bias,
                               std::int64_t in, float* y, std::int64_t out_stride,
                               std::int64_t columns, std::int64_t rows) {
  std::int64_t r = 0;
  for (; r + 4 <= rows; r += 4)
    panel_rows<4>(x + r * in, panel, bias, in, y + r * out_stride, out_stride, columns);
  for (; r < rows; ++r)
    panel_rows<1>(x + r * in, panel, bias, in, y + r * out_stride, out_stride, columns);
}

MOCAPLM_INLINE void attend_body(const float* query, const float* keys, const float* values,
                                std::int64_t count, std::int64_t stride, std::int64_t width,
                                float* scores, float* out) {
  const float scale = 1 / std::sqrt(static_cast<float>(width));
  float top = -INFINITY;
  for (std::int64_t t = 0; t < count; ++t) {
    const float* key = keys + t * stride;
    float sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::int64_t d = 0; d < width; ++d) sum += query[d] * key[d];
    scores[t] = sum * scale;
    top = std::max(top, scores[t]);
  }
  float total = 0;
  for (std::int64_t t = 0; t < count; ++t) total += scores[t] = std::exp(scores[t] - top);
  std::fill(out, out + width, 0.f);
  for (std::int64_t t = 0; t < count; ++t) {
    const float weight = scores[t] / total;
    const float* value = values + t * stride;
#pragma omp simd
    for (std::int64_t d = 0; d < width; ++d) out[d] += weight * value[d];
  }
}

using PanelFunction = void (*)(const float*, const float*, const float*, std::int64_t, float*,
                               std::int64_t, std::int64_t, std::int64_t);
using AttendFunction = void (*)(const float*, const float*, const float*, std::int64_t,
                                std::int64_t, std::int64_t, float*, float*);

void panel_plain(const float* x, const float* p, const float* b, std::int64_t in, float* y,
                 std::int64_t s, std::int64_t c, std::int64_t r) {
  panel_body(x, p, b, in, y, s, c, r);
}
MOCAPLM_AVX2 void panel_avx2(const float* x, const float* p, const float* b, std::int64_t in,
                             float* y, std::int64_t s, std::int64_t c, std::int64_t r) {
  panel_body(x, p, b, in, y, s, c, r);
}
MOCAPLM_AVX512 void panel_avx512(const float* x, const float* p, const float* b, std::int64_t in,
                                 float* y, std::int64_t s, std::int64_t c, std::int64_t r) {
  panel_body(x, p, b, in, y, s, c, r);
}
void attend_plain(const float* q, const float* k, const float* v, std::int64_t n, std::int64_t s,
                  std::int64_t w, float* t, float* o) {
  attend_body(q, k, v, n, s, w, t, o);
}
MOCAPLM_AVX2 void attend_avx2(const float* q, const float* k, const float* v, std::int64_t n,
                              std::int64_t s, std::int64_t w, float* t, float* o) {
  attend_body(q, k, v, n, s, w, t, o);
}
MOCAPLM_AVX512 void attend_avx512(const float* q, const float* k, const float* v, std::int64_t n,
                                  std::int64_t s, std::int64_t w, float* t, float* o) {
  attend_body(q, k, v, n, s, w, t, o);
}

KernelLevel& current_level() {
  static KernelLevel level = best_kernel_level();
  return level;
}

PanelFunction panel_function() {
  switch (kernel_level()) {
    case KernelLevel::avx512:
      return panel_avx512;
    case KernelLevel::avx2:
      return panel_avx2;
    default:
      return panel_plain;
  }
}

AttendFunction attend_function() {
  switch (kernel_level()) {
    case KernelLevel::avx512:
      return attend_avx512;
    case KernelLevel::avx2:
      return attend_avx2;
    default:
      return attend_plain;
  }
}

}  // namespace

KernelLevel best_kernel_level() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq"))
    return KernelLevel::avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return KernelLevel::avx2;
#endif
  return KernelLevel::plain;
}

KernelLevel kernel_level() {
  return current_level();
}

void set_kernel_level(KernelLevel level) {
  current_level() = std::min(level, best_kernel_level());
}

std::string to_string(KernelLevel level) {
  return level == KernelLevel::avx512 ? "AVX-512"
         : level == KernelLevel::avx2 ? "AVX2"
                                      : "plain C++";
}

void set_engine_threads(int threads) {
  omp_set_num_threads(threads > 0 ? threads : omp_get_num_procs());
}

PackedLinear::PackedLinear(const float* weight, const float* bias, std::int64_t out,
                           std::int64_t in)
    : out_(out), in_(in) {
  const std::int64_t panels = (out + kPanel - 1) / kPanel;
  panels_.assign(static_cast<std::size_t>(panels * in * kPanel), 0.f);
  bias_.assign(static_cast<std::size_t>(panels * kPanel), 0.f);
  std::copy(bias, bias + out, bias_.begin());
  for (std::int64_t o = 0; o < out; ++o)
    for (std::int64_t k = 0; k < in; ++k)
      panels_[static_cast<std::size_t>((o / kPanel * in + k) * kPanel + o % kPanel)] =
          weight[o * in + k];
}

void PackedLinear::apply(const float* x, float* y, std::int64_t rows) const {
  const PanelFunction panel = panel_function();
  const std::int64_t panels = (out_ + kPanel - 1) / kPanel;
#pragma omp parallel for schedule(static) if (rows * out_ * in_ > 20000)
  for (std::int64_t p = 0; p < panels; ++p)
    panel(x, panels_.data() + p * in_ * kPanel, bias_.data() + p * kPanel, in_, y + p * kPanel,
          out_, std::min(kPanel, out_ - p * kPanel), rows);
}

void attend(const float* query, const float* keys, const float* values, std::int64_t count,
            std::int64_t stride, std::int64_t width, float* scores, float* out) {
  attend_function()(query, keys, values, count, stride, width, scores, out);
}

void layer_norm(const float* x, const float* weight, const float* bias, std::int64_t rows,
                std::int64_t width, float* y) {
  for (std::int64_t r = 0; r < rows; ++r, x += width, y += width) {
    double mean = 0, square = 0;
    for (std::int64_t i = 0; i < width; ++i) mean += x[i];
    mean /= static_cast<double>(width);
    for (std::int64_t i = 0; i < width; ++i) square += (x[i] - mean) * (x[i] - mean);
    const double scale = 1 / std::sqrt(square / static_cast<double>(width) + 1e-5);
    for (std::int64_t i = 0; i < width; ++i)
      y[i] = static_cast<float>((x[i] - mean) * scale) * weight[i] + bias[i];
  }
}

void gelu(float* x, std::int64_t count) {
  constexpr float kRootHalf = 0.7071067811865476f;
  for (std::int64_t i = 0; i < count; ++i) x[i] *= 0.5f * (1 + std::erf(kRootHalf * x[i]));
}

}  // namespace mocaplm
