// Transformer blocks written down a second time: whole matrices in double precision, LibTorch's
// simplest operations, nothing fused. What models are compared with.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "model/safetensors.h"
#include "model/transformer/torch.h"
#include "support/tensors.h"

namespace mocaplm {

class PlainTransformer {
 public:
  explicit PlainTransformer(const TensorMap& weights) {
    for (const auto& [name, tensor] : weights)
      weights_[name] =
          at::from_blob(const_cast<float*>(tensor.values.data()), tensor.shape, at::kFloat)
              .to(at::kDouble)
              .clone()
              .set_requires_grad(true);
  }
  // Each has a gradient after a backward pass through what it was used for.
  const std::map<std::string, at::Tensor>& weights() const { return weights_; }

 protected:
  const at::Tensor& weight(const std::string& name) const { return weights_.at(name); }
  at::Tensor row(const std::string& table, std::int64_t index) const {
    return weight(table)[index];
  }
  at::Tensor linear(const std::string& name, const at::Tensor& x) const {
    return at::matmul(x, weight(name + ".weight").t()) + weight(name + ".bias");
  }
  at::Tensor norm(const std::string& name, const at::Tensor& x) const {
    const at::Tensor centred = x - x.mean({-1}, true);
    return centred / (centred.square().mean({-1}, true) + 1e-5).sqrt() * weight(name + ".weight") +
           weight(name + ".bias");
  }
  static at::Tensor gelu(const at::Tensor& x) { return 0.5 * x * (1 + at::erf(x / std::sqrt(2))); }

  // x (..., T, C); the last `free` positions see all the others.
  at::Tensor blocks(const std::string& name, std::int64_t layers, std::int64_t heads, at::Tensor x,
                    std::int64_t free = 0) const {
    for (std::int64_t i = 0; i < layers; ++i) {
      const std::string at = name + std::to_string(i) + ".";
      x = x + linear(at + "proj", attention(linear(at + "qkv", norm(at + "ln1", x)), heads, free));
      x = x + linear(at + "down", gelu(linear(at + "up", norm(at + "ln2", x))));
    }
    return x;
  }

 private:
  static at::Tensor attention(const at::Tensor& qkv, std::int64_t heads, std::int64_t free) {
    const std::int64_t length = qkv.size(-2), width = qkv.size(-1) / 3, head = width / heads;
    at::Tensor mask =
        at::full({length, length}, -std::numeric_limits<double>::infinity(), at::kDouble).triu(1);
    if (free > 0) mask.slice(0, length - free).zero_();
    std::vector<at::Tensor> outs;
    for (std::int64_t h = 0; h < heads; ++h) {
      const auto part = [&](std::int64_t which) {
        return qkv.narrow(-1, which * width + h * head, head);
      };
      const at::Tensor scores =
          at::matmul(part(0), part(1).transpose(-1, -2)) / std::sqrt(static_cast<double>(head));
      outs.push_back(at::matmul(at::softmax(scores + mask, -1), part(2)));
    }
    return at::cat(outs, -1);
  }

  std::map<std::string, at::Tensor> weights_;
};

// Cross-entropy (B, T) of logits (B, T, V), 0 where there is no target (-1).
inline at::Tensor plain_loss(const at::Tensor& logits, const at::Tensor& target) {
  const at::Tensor picked =
      at::log_softmax(logits, -1).gather(2, target.clamp_min(0).unsqueeze(2)).squeeze(2);
  return at::where(target >= 0, -picked, at::zeros_like(picked));
}

// Each parameter's gradient is the reference's: apart by `tolerance` at most, and by that share of
// its largest value. `what`: the model, for the message.
inline void expect_same_gradients(const torch::nn::Module& model, const PlainTransformer& reference,
                                  double tolerance, const std::string& what) {
  for (const auto& item : model.named_parameters()) {
    std::string name = item.key();
    std::replace(name.begin(), name.end(), '/', '.');
    const at::Tensor gradient = item.value().grad(), expected = reference.weights().at(name).grad();
    ASSERT_TRUE(gradient.defined()) << name << ", " << what;
    EXPECT_LT(largest_difference(gradient, expected),
              tolerance * (1 + expected.abs().max().item<double>()))
        << name << ", " << what;
  }
}

}  // namespace mocaplm
