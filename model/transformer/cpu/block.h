// A transformer block's steps on processors with AVX512_BF16, forward and backward: layer norm, the
// products of its linear layers with what follows them (bias, GELU, dropout, residual) done while a
// strip of the result is in the cache, and the gradients of the weights. Matrices are row-major,
// one row a token; every step takes the rows `first` to `last`, so that a thread can carry a few
// rows through several steps. Pointers only: the autograd function around it is in ../block.cpp.
#pragma once

#include <cstdint>

#include "model/transformer/cpu/attention.h"

namespace mocaplm::cpu {

// Rows of a call that still fit the cache beside what they are multiplied with.
constexpr std::int64_t kBlockRows = 128;

// Dropout of an (M, columns) matrix: the mask of dropout_mask (../dropout.h) for this seed. p = 0:
// none.
struct DropoutMask {
  double p = 0;
  std::uint64_t seed = 0;
};

// y (M, columns) = x (M, depth) times `weights`, which pack_* wrote for this depth and these
// columns. Depth is even.
struct Product {
  const bf16* x;
  std::int64_t depth;
  const bf16* weights;
  std::int64_t columns;
};

struct BlockKernels {
  // w (rows, columns) f32 as the right factor of x w^T and of y w: packed_size values each. Panels
  // of 64 output columns, `first` to `last`.
  void (*pack_transposed)(const float* w, std::int64_t rows, std::int64_t columns, bf16* packed,
                          std::int64_t first, std::int64_t last);
  void (*pack)(const float* w, std::int64_t rows, std::int64_t columns, bf16* packed,
               std::int64_t first, std::int64_t last);

  // y = product + bias, in bf16 or f32; bias may be null.
  void (*linear)(const Product& p, const float* bias, bf16* y, std::int64_t first,
                 std::int64_t last);
  void (*linear_f32)(const Product& p, const float* bias, float* y, std::int64_t first,
                     std::int64_t last);
  // y = GELU(product + bias), the exact one; slope: its derivative there, may be null.
  void (*linear_gelu)(const Product& p, const float* bias, bf16* y, bf16* slope, std::int64_t first,
                      std::int64_t last);
  // y = x + dropout(product + bias)
  void (*linear_residual)(const Product& p, const float* bias, const DropoutMask& mask,
                          const float* x, float* y, std::int64_t first, std::int64_t last);
  // y = product times factor, element by element
  void (*linear_times)(const Product& p, const bf16* factor, bf16* y, std::int64_t first,
                       std::int64_t last);

  // y = (x - mean) / sqrt(variance + 1e-5) * weight + bias; stats (M, 2): mean and 1 / sqrt(...).
  void (*layer_norm)(const float* x, std::int64_t width, const float* weight, const float* bias,
                     bf16* y, float* stats, std::int64_t first, std::int64_t last);
  // dx = residual + the gradient through the layer norm of dy; adds to dweight and dbias (width).
  // dx may be residual.
  void (*layer_norm_backward)(const bf16* dy, const float* x, const float* stats,
                              std::int64_t width, const float* weight, const float* residual,
                              float* dx, float* dweight, float* dbias, std::int64_t first,
                              std::int64_t last);
  // y (M, stride) = x (M, columns) after dropout, zeros past the columns.
  void (*to_halves)(const float* x, std::int64_t columns, const DropoutMask& mask, bf16* y,
                    std::int64_t stride, std::int64_t first, std::int64_t last);

  // z (n) becomes its softmax; returns the log of the sum of its exponentials.
  float (*softmax)(float* z, std::int64_t n);

  // dw (rows, columns) = dy^T x and db (rows) = the sums of dy over `tokens`; dy (tokens, stride)
  // with stride >= rows, x (tokens, columns). In gradient_tasks parts, `first` to `last`.
  void (*weight_gradient)(const bf16* dy, std::int64_t stride, const bf16* x, std::int64_t tokens,
                          std::int64_t rows, std::int64_t columns, float* dw, float* db,
                          std::int64_t first, std::int64_t last);
};

// Null where this processor cannot run them.
const BlockKernels* block_kernels();
// Whether they can do products of this depth (a multiple of 16), and blocks of this width and
// number of heads.
bool products_available(std::int64_t depth);
bool block_available(std::int64_t width, std::int64_t heads);

std::int64_t packed_size(std::int64_t depth, std::int64_t columns);
std::int64_t packed_panels(std::int64_t columns);
std::int64_t gradient_tasks(std::int64_t rows, std::int64_t columns);

}  // namespace mocaplm::cpu
