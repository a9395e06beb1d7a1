// The kernels as plain loops, which the compiler turns into the instructions that the including
// file is compiled for. Everything is in an unnamed namespace: a copy shared between files could be
// one with instructions that the processor lacks.
#pragma once

#include <cstdint>
#include <cstring>

#include "generate/kernels/kernels.h"

namespace mocaplm {
namespace {

constexpr std::int64_t kLine = 64;  // bytes of a cache line

// Rounded up to whole blocks of lanes.
inline std::int64_t whole_lanes(std::int64_t count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

inline float from_bits(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}
inline float lower(std::uint32_t word) {
  return from_bits(word << 16);
}
inline float upper(std::uint32_t word) {
  return from_bits(word & 0xffff0000U);
}

// e^x for x <= 0, 0 far below: 2^n times a polynomial on [-ln 2 / 2, ln 2 / 2] (Taylor to the
// sixth power: relative error under 2e-7).
inline float exponential(float x) {
  x = x < -87.f ? -87.f : x;
  constexpr float kRound = 12582912.f;  // 1.5 * 2^23: adding it leaves the nearest integer
  const float n = (x * 1.44269504f + kRound) - kRound;
  const float r = (x - n * 0.693145752f) - n * 1.42860677e-6f;
  float p = 1.f / 720;
  p = p * r + 1.f / 120;
  p = p * r + 1.f / 24;
  p = p * r + 1.f / 6;
  p = p * r + 0.5f;
  p = p * r + 1.f;
  p = p * r + 1.f;
  return p * from_bits(static_cast<std::uint32_t>(static_cast<std::int32_t>(n) + 127) << 23);
}

// x Phi(x) with the error function of Abramowitz and Stegun, 7.1.26 (absolute error 1.5e-7).
inline float gelu(float x) {
  const float z = (x < 0 ? -x : x) * 0.7071067811865476f;
  const float t = 1 / (1 + 0.3275911f * z);
  float p = 1.061405429f;
  p = p * t - 1.453152027f;
  p = p * t + 1.421413741f;
  p = p * t - 0.284496736f;
  p = p * t + 0.254829592f;
  const float tail = 0.5f * p * t * exponential(-z * z);  // Phi(-|x|)
  return x * (x < 0 ? tail : 1 - tail);
}

// Asks for the next `lines` cache lines.
inline void ask(Ahead& ahead, int lines) {
  if (ahead.at >= ahead.end) {
    if (ahead.piece == nullptr) return;
    if (++ahead.piece == ahead.last) ahead.piece = ahead.first;
    ahead.at = ahead.piece->begin;
    ahead.end = ahead.piece->end;
  }
  for (int i = 0; i < lines; ++i) __builtin_prefetch(ahead.at + i * kLine, 0, 2);
  ahead.at += lines * kLine;
}

template <int Rows, int Columns>
inline void product_f32_tile(const float* x, std::int64_t depth, const float* panel, float* tile) {
  float sums[Rows][Columns] = {};
  for (std::int64_t k = 0; k < depth; ++k)
    for (int r = 0; r < Rows; ++r)
      for (int j = 0; j < Columns; ++j) sums[r][j] += x[r * depth + k] * panel[k * kPanel + j];
  for (int r = 0; r < Rows; ++r) std::memcpy(tile + r * kPanel, sums[r], sizeof sums[r]);
}

void product_f32(const float* x, std::int64_t rows, std::int64_t depth, const float* panel,
                 float* tile) {
  std::int64_t r = 0;
  for (; r + 4 <= rows; r += 4)
    for (std::int64_t c = 0; c < kPanel; c += 32)
      product_f32_tile<4, 32>(x + r * depth, depth, panel + c, tile + r * kPanel + c);
  for (; r < rows; ++r) product_f32_tile<1, 64>(x + r * depth, depth, panel, tile + r * kPanel);
}

// Rows stay f32 where the processor has no product of bf16 pairs.
void prepare_bf16(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                  void* prepared) {
  auto* to = static_cast<float*>(prepared);
  for (std::int64_t r = 0; r < rows; ++r) {
    std::memcpy(to + r * 2 * depth, x + r * in, static_cast<std::size_t>(in) * sizeof(float));
    if (in < 2 * depth) to[r * 2 * depth + in] = 0;
  }
}

template <int Rows, int Columns>
inline void product_bf16_tile(const float* x, std::int64_t depth, const std::uint32_t* panel,
                              float* tile) {
  float sums[Rows][Columns] = {};
  for (std::int64_t k = 0; k < depth; ++k)
    for (int r = 0; r < Rows; ++r) {
      const float first = x[r * 2 * depth + 2 * k], second = x[r * 2 * depth + 2 * k + 1];
      for (int j = 0; j < Columns; ++j)
        sums[r][j] += first * lower(panel[k * kPanel + j]) + second * upper(panel[k * kPanel + j]);
    }
  for (int r = 0; r < Rows; ++r) std::memcpy(tile + r * kPanel, sums[r], sizeof sums[r]);
}

void product_bf16(const void* prepared, std::int64_t rows, std::int64_t depth,
                  const std::uint32_t* panel, float* tile, Ahead&) {
  const auto* x = static_cast<const float*>(prepared);
  std::int64_t r = 0;
  for (; r + 4 <= rows; r += 4)
    for (std::int64_t c = 0; c < kPanel; c += 32)
      product_bf16_tile<4, 32>(x + r * 2 * depth, depth, panel + c, tile + r * kPanel + c);
  for (; r < rows; ++r)
    product_bf16_tile<1, 64>(x + r * 2 * depth, depth, panel, tile + r * kPanel);
}

// The largest |x|: lane by lane, for the order of comparisons is the program's.
inline float largest_size(const float* x, std::int64_t count) {
  float tops[kLanes] = {};
  std::int64_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (std::int64_t j = 0; j < kLanes; ++j) {
      const float size = x[i + j] < 0 ? -x[i + j] : x[i + j];
      tops[j] = size > tops[j] ? size : tops[j];
    }
  for (; i < count; ++i) {
    const float size = x[i] < 0 ? -x[i] : x[i];
    tops[0] = size > tops[0] ? size : tops[0];
  }
  for (std::int64_t j = 1; j < kLanes; ++j) tops[0] = tops[j] > tops[0] ? tops[j] : tops[0];
  return tops[0];
}

// The largest of x, at least `least`; lane by lane too.
inline float largest(const float* x, std::int64_t count, float least) {
  float tops[kLanes];
  for (std::int64_t j = 0; j < kLanes; ++j) tops[j] = least;
  std::int64_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (std::int64_t j = 0; j < kLanes; ++j) tops[j] = x[i + j] > tops[j] ? x[i + j] : tops[j];
  for (; i < count; ++i) tops[0] = x[i] > tops[0] ? x[i] : tops[0];
  for (std::int64_t j = 1; j < kLanes; ++j) tops[0] = tops[j] > tops[0] ? tops[j] : tops[0];
  return tops[0];
}

// round(x / scale) for every value of a row, zeros up to 4 * depth; `Offset` is added to each.
template <class Value, int Offset>
inline void quantise(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                     void* prepared, float* scale) {
  for (std::int64_t r = 0; r < rows; ++r) {
    const float* row = x + r * in;
    Value* to = static_cast<Value*>(prepared) + r * 4 * depth;
    const float top = largest_size(row, in);
    scale[r] = top / 127;
    const float inverse = top > 0 ? 127 / top : 0;
    constexpr float kRound = 12582912.f;
    for (std::int64_t k = 0; k < in; ++k)
      to[k] = static_cast<Value>(static_cast<std::int32_t>((row[k] * inverse + kRound) - kRound) +
                                 Offset);
    for (std::int64_t k = in; k < 4 * depth; ++k) to[k] = static_cast<Value>(Offset);
  }
}

void prepare_int8(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                  void* prepared, float* scale) {
  quantise<std::int8_t, 0>(x, rows, in, depth, prepared, scale);
}

void product_int8(const void* prepared, std::int64_t rows, std::int64_t depth,
                  const std::uint32_t* panel, const std::int32_t*, float* tile, Ahead&) {
  const auto* x = static_cast<const std::int8_t*>(prepared);
  const auto* weights = reinterpret_cast<const std::int8_t*>(panel);
  for (std::int64_t r = 0; r < rows; ++r) {
    std::int32_t sums[kPanel] = {};
    for (std::int64_t k = 0; k < depth; ++k) {
      const std::int8_t* four = x + (r * depth + k) * 4;
      const std::int8_t* w = weights + k * kPanel * 4;
      for (std::int64_t j = 0; j < kPanel; ++j)
        sums[j] += four[0] * w[4 * j] + four[1] * w[4 * j + 1] + four[2] * w[4 * j + 2] +
                   four[3] * w[4 * j + 3];
    }
    for (std::int64_t j = 0; j < kPanel; ++j) tile[r * kPanel + j] = static_cast<float>(sums[j]);
  }
}

// Softmax in place over `count` scores; the padding up to whole blocks becomes 0. Returns 1 / sum,
// which is left to the caller.
inline float softmax(float* scores, std::int64_t count) {
  const float top = largest(scores, count, scores[0]);
  float total = 0;
#pragma omp simd reduction(+ : total)
  for (std::int64_t t = 0; t < count; ++t) {
    scores[t] = exponential(scores[t] - top);
    total += scores[t];
  }
  for (std::int64_t t = count; t % kLanes != 0; ++t) scores[t] = 0;
  return 1 / total;
}

void attend_f32(const float* query, const std::uint32_t* key_words,
                const std::uint32_t* value_words, std::int64_t count, std::int64_t width,
                float* scores, float* out) {
  const auto* keys = reinterpret_cast<const float*>(key_words);
  const auto* values = reinterpret_cast<const float*>(value_words);
  for (std::int64_t first = 0; first < count; first += kLanes) {
    float sums[kLanes] = {};
    for (std::int64_t d = 0; d < width; ++d, keys += kLanes)
      for (std::int64_t j = 0; j < kLanes; ++j) sums[j] += query[d] * keys[j];
    std::memcpy(scores + first, sums, sizeof sums);
  }
  const float scale = softmax(scores, count);
  const std::int64_t padded = whole_lanes(width);
  for (std::int64_t c = 0; c < width; c += kLanes) {
    float sums[kLanes] = {};
    for (std::int64_t t = 0; t < count; ++t)
      for (std::int64_t j = 0; j < kLanes; ++j) sums[j] += scores[t] * values[t * padded + c + j];
    for (std::int64_t j = 0; j < kLanes && c + j < width; ++j) out[c + j] = sums[j] * scale;
  }
}

void attend_bf16(const float* query, const std::uint32_t* keys, const std::uint32_t* values,
                 std::int64_t count, std::int64_t width, float* scores, float* out, Ahead&) {
  for (std::int64_t first = 0; first < count; first += kLanes) {
    float sums[kLanes] = {};
    for (std::int64_t d = 0; d < width; d += 2, keys += kLanes) {
      const float second = d + 1 < width ? query[d + 1] : 0;
      for (std::int64_t j = 0; j < kLanes; ++j)
        sums[j] += query[d] * lower(keys[j]) + second * upper(keys[j]);
    }
    std::memcpy(scores + first, sums, sizeof sums);
  }
  const float scale = softmax(scores, count);
  const std::int64_t padded = whole_lanes(width);
  for (std::int64_t c = 0; c < width; c += kLanes) {
    float sums[kLanes] = {};
    for (std::int64_t t = 0; t < count; t += 2) {
      const std::uint32_t* two = values + t / 2 * padded + c;
      for (std::int64_t j = 0; j < kLanes; ++j)
        sums[j] += scores[t] * lower(two[j]) + scores[t + 1] * upper(two[j]);
    }
    for (std::int64_t j = 0; j < kLanes && c + j < width; ++j) out[c + j] = sums[j] * scale;
  }
}

void layer_norm(const float* x, const float* weight, const float* bias, std::int64_t rows,
                std::int64_t width, float* y) {
  const float share = 1 / static_cast<float>(width);
  for (std::int64_t r = 0; r < rows; ++r, x += width, y += width) {
    float sum = 0, rest = 0, square = 0;
#pragma omp simd reduction(+ : sum)
    for (std::int64_t i = 0; i < width; ++i) sum += x[i];
    float mean = sum * share;
    // A second look takes away what rounding left in the mean.
#pragma omp simd reduction(+ : rest)
    for (std::int64_t i = 0; i < width; ++i) rest += x[i] - mean;
    mean += rest * share;
#pragma omp simd reduction(+ : square)
    for (std::int64_t i = 0; i < width; ++i) square += (x[i] - mean) * (x[i] - mean);
    const float scale = 1 / __builtin_sqrtf(square * share + 1e-5f);
    for (std::int64_t i = 0; i < width; ++i) y[i] = (x[i] - mean) * scale * weight[i] + bias[i];
  }
}

inline float finished(const float* tile, const float* scale, float row_scale, const float* bias,
                      std::int64_t j) {
  return (scale == nullptr ? tile[j] : tile[j] * (scale[j] * row_scale)) + bias[j];
}

void store(const float* tile, const float* scale, float row_scale, const float* bias,
           std::int64_t count, float* y) {
  for (std::int64_t j = 0; j < count; ++j) y[j] = finished(tile, scale, row_scale, bias, j);
}

void store_gelu(const float* tile, const float* scale, float row_scale, const float* bias,
                std::int64_t count, float* y) {
  for (std::int64_t j = 0; j < count; ++j) y[j] = gelu(finished(tile, scale, row_scale, bias, j));
}

void store_sum(const float* tile, const float* scale, float row_scale, const float* bias,
               std::int64_t count, float* y) {
  for (std::int64_t j = 0; j < count; ++j) y[j] += finished(tile, scale, row_scale, bias, j);
}

}  // namespace
}  // namespace mocaplm
