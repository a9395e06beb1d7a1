// The inner loops of the decoding engine: one table of functions for each KernelLevel. Pointers
// only; the layouts are those of PackedLinear (linear.h) and KeyValueCache (cache.h).
//
// Two bf16 values share a 32-bit word, the first in its lower half. Four int8 values likewise.
//
// Where a function takes an `ahead`, it may ask for as much memory there as it reads itself.
#pragma once

#include <cstdint>

#include "generate/kernels/ahead.h"
#include "generate/kernels/level.h"

namespace mocaplm {

constexpr std::int64_t kPanel = 64;    // outputs of a packed panel
constexpr std::int64_t kLanes = 16;    // positions of a block of keys, and the padding of values
constexpr std::int64_t kMaxRows = 64;  // rows (positions) computed together

// Keys and values of one head in 8 bits (cache.h): value = byte * scale of its position.
struct ByteHead {
  std::uint32_t *keys, *values;
  float *key_scale, *value_scale;
  std::int32_t* key_offset;  // 128 times the sum of each key's bytes
};

struct Kernels {
  // tile (rows, kPanel) = x (rows, depth) times one panel (depth, kPanel).
  void (*product_f32)(const float* x, std::int64_t rows, std::int64_t depth, const float* panel,
                      float* tile);

  // x (rows, in) as product_bf16 wants it: `depth` words of two values a row (at most 2 * depth
  // floats are written a row), zeros past the end.
  void (*prepare_bf16)(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                       void* prepared);
  // tile (rows, kPanel) = prepared times one panel (depth, kPanel) of pairs.
  void (*product_bf16)(const void* prepared, std::int64_t rows, std::int64_t depth,
                       const std::uint32_t* panel, float* tile, Ahead& ahead);

  // x (rows, in) as product_int8 wants it: round(x / scale), scale = max |row| / 127; zeros past
  // the end up to 4 * depth.
  void (*prepare_int8)(const float* x, std::int64_t rows, std::int64_t in, std::int64_t depth,
                       void* prepared, float* scale);
  // tile (rows, kPanel) = the exact integer product with one panel (depth, kPanel) of quadruples,
  // as floats; `sums` (kPanel) are the sums of the panel's columns.
  void (*product_int8)(const void* prepared, std::int64_t rows, std::int64_t depth,
                       const std::uint32_t* panel, const std::int32_t* sums, float* tile,
                       Ahead& ahead);

  // out (width) = softmax(query . keys) values over the first `count` positions of one head; the
  // query (width) is scaled already. `scores` is scratch of `count` rounded up to kLanes floats.
  void (*attend_f32)(const float* query, const std::uint32_t* keys, const std::uint32_t* values,
                     std::int64_t count, std::int64_t width, float* scores, float* out);
  void (*attend_bf16)(const float* query, const std::uint32_t* keys, const std::uint32_t* values,
                      std::int64_t count, std::int64_t width, float* scores, float* out,
                      Ahead& ahead);

  // The same over 8-bit numbers; null where the processor does not make that fast. `scores` is
  // scratch of twice as many floats, and of `width` more.
  void (*attend_int8)(const float* query, const ByteHead& head, std::int64_t count,
                      std::int64_t width, float* scores, float* out, Ahead& ahead);
  // Puts key and value (width) of one position into such a head; null likewise.
  void (*put_int8)(const float* key, const float* value, std::int64_t width, std::int64_t position,
                   const ByteHead& head);

  // y (rows, width): each row of x brought to mean 0 and variance 1 (epsilon 1e-5), then scaled and
  // shifted.
  void (*layer_norm)(const float* x, const float* weight, const float* bias, std::int64_t rows,
                     std::int64_t width, float* y);

  // What happens to `count` columns of a product before it is stored: y = scale * tile + bias with
  // the GELU x Phi(x) after it, or added to y. `scale` may be null (1).
  void (*store)(const float* tile, const float* scale, float row_scale, const float* bias,
                std::int64_t count, float* y);
  void (*store_gelu)(const float* tile, const float* scale, float row_scale, const float* bias,
                     std::int64_t count, float* y);
  void (*store_sum)(const float* tile, const float* scale, float row_scale, const float* bias,
                    std::int64_t count, float* y);
};

// The table of kernel_level().
const Kernels& kernels();

extern const Kernels kPlainKernels;
#if defined(MOCAPLM_X86_KERNELS)
extern const Kernels kAvx2Kernels, kAvx512Kernels, kAvx512Bf16Kernels;
#endif

}  // namespace mocaplm
