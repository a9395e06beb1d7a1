// A linear layer's weights as the kernels want them.
#pragma once

#include <memory>

#include "model/transformer/torch.h"

namespace mocaplm {

// Copies of a weight matrix in bf16, made again when it has changed: by its version, which whoever
// writes in place raises (LibTorch's operations do, train/optimizer.cpp does).
class PackedWeights {
 public:
  // weight: (out, in) f32. The right factor of x w^T, and of dy w.
  const at::Tensor& forward(const at::Tensor& weight) { return made(weight, forward_, true); }
  const at::Tensor& backward(const at::Tensor& weight) { return made(weight, backward_, false); }

 private:
  struct Copy {
    at::Tensor values;
    const void* data = nullptr;
    std::int64_t version = 0;
  };
  static const at::Tensor& made(const at::Tensor& weight, Copy& copy, bool transposed);

  Copy forward_, backward_;
};

struct LinearWeights {
  at::Tensor weight, bias;  // (out, in), (out)
  std::shared_ptr<PackedWeights> packed = std::make_shared<PackedWeights>();
};

}  // namespace mocaplm
