// Takes tensors out of a stored model, checking their shapes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/error.h"
#include "generate/kernels/linear.h"
#include "model/safetensors.h"

namespace mocaplm {

class Weights {
 public:
  Weights(const TensorMap& tensors, std::string place)
      : tensors_(tensors), place_(std::move(place)) {}

  // Throws DataError when it is missing or of another shape.
  const std::vector<float>& take(const std::string& name, const std::vector<std::int64_t>& shape) {
    const auto found = tensors_.find(name);
    if (found == tensors_.end())
      throw DataError(in_file(place_), "tensor \"" + name + "\" is missing");
    if (found->second.shape != shape)
      throw DataError(in_file(place_),
                      "tensor \"" + name + "\" has another shape than the config asks for");
    ++taken_;
    return found->second.values;
  }

  // Throws DataError when there are tensors that nobody took.
  void finish() const {
    if (taken_ != tensors_.size())
      throw DataError(in_file(place_), "holds tensors that are not part of this model");
  }

 private:
  const TensorMap& tensors_;
  std::string place_;
  std::size_t taken_ = 0;
};

// A linear layer: NAME.weight (out, in) and NAME.bias (out).
inline PackedLinear packed(Weights& weights, const std::string& name, std::int64_t out,
                           std::int64_t in, Precision precision, Arena& arena) {
  const float* weight = weights.take(name + ".weight", {out, in}).data();
  return PackedLinear(weight, weights.take(name + ".bias", {out}).data(), out, in, precision,
                      arena);
}

}  // namespace mocaplm
