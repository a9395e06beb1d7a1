// What the autograd functions around the kernels of cpu/block.h share.
#pragma once

#include <ATen/Parallel.h>
#include <ATen/record_function.h>

#include <algorithm>
#include <atomic>

#include "model/transformer/cpu/block.h"
#include "model/transformer/packed_weights.h"
#include "model/transformer/torch.h"

namespace mocaplm {

inline cpu::bf16* halves(const at::Tensor& tensor) {
  return reinterpret_cast<cpu::bf16*>(tensor.data_ptr<at::BFloat16>());
}
inline float* floats(const at::Tensor& tensor) {
  return tensor.data_ptr<float>();
}
inline at::Tensor half_matrix(std::int64_t rows, std::int64_t columns) {
  return at::empty({rows, columns}, at::kBFloat16);
}
inline at::Tensor float_matrix(std::int64_t rows, std::int64_t columns) {
  return at::empty({rows, columns}, at::kFloat);
}

// Calls step(part) for every part. A thread takes the next one when it is done, so that one that is
// held up (a machine is seldom all ours) does not hold up the rest.
template <class Step>
void in_turn(std::int64_t parts, const Step& step) {
  std::atomic<std::int64_t> next{0};
  const std::int64_t threads = std::min<std::int64_t>(at::get_num_threads(), parts);
  at::parallel_for(0, threads, 1, [&](std::int64_t, std::int64_t) {
    for (std::int64_t part = next++; part < parts; part = next++) step(part);
  });
}

// Calls step(first, last, part) for blocks of rows: the same blocks for any number of threads.
template <class Step>
void over_rows(std::int64_t rows, const Step& step) {
  const std::int64_t parts = (rows + cpu::kBlockRows - 1) / cpu::kBlockRows;
  in_turn(parts, [&](std::int64_t part) {
    step(part * cpu::kBlockRows, std::min((part + 1) * cpu::kBlockRows, rows), part);
  });
}

// x (M, in) w^T and dy (M, out) w.
inline cpu::Product times_transposed(const at::Tensor& x, const LinearWeights& w) {
  return {halves(x), x.size(1), halves(w.packed->forward(w.weight)), w.weight.size(0)};
}
inline cpu::Product times(const at::Tensor& dy, const LinearWeights& w) {
  return {halves(dy), dy.size(1), halves(w.packed->backward(w.weight)), w.weight.size(1)};
}

// The gradients of a layer norm's weight and bias, summed block of rows by block of rows.
struct NormSums {
  NormSums(std::int64_t rows, std::int64_t columns)
      : width(columns),
        parts(at::zeros({(rows + cpu::kBlockRows - 1) / cpu::kBlockRows, 2, columns}, at::kFloat)) {
  }
  float* weight(std::int64_t part) const { return floats(parts) + 2 * part * width; }
  float* bias(std::int64_t part) const { return weight(part) + width; }

  std::int64_t width;
  at::Tensor parts;
};

struct LinearGradient {
  at::Tensor weight, bias;
};
// dy (M, at least out), x (M, in) in bf16.
inline LinearGradient linear_gradient(const at::Tensor& dy, const at::Tensor& x,
                                      const LinearWeights& w) {
  RECORD_USER_SCOPE("linears, weights");
  const std::int64_t rows = w.weight.size(0), columns = w.weight.size(1);
  const LinearGradient out{float_matrix(rows, columns), at::empty({rows}, at::kFloat)};
  at::parallel_for(0, cpu::gradient_tasks(rows, columns), 1, [&](std::int64_t a, std::int64_t b) {
    cpu::block_kernels()->weight_gradient(halves(dy), dy.size(1), halves(x), x.size(0), rows,
                                          columns, floats(out.weight), floats(out.bias), a, b);
  });
  return out;
}

}  // namespace mocaplm
