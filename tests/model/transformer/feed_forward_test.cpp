// The feed-forward layer: its definition, and the kernels against LibTorch's operations.
#include "model/transformer/feed_forward.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mocaplm::feed_forward_test {

namespace {

FeedForwardWeights random_weights(std::int64_t width, std::int64_t wide) {
  at::manual_seed(1);
  const auto make = [](at::IntArrayRef shape, double deviation, double mean = 0) {
    return (at::randn(shape) * deviation + mean).requires_grad_(true);
  };
  FeedForwardWeights w;
  w.ln_w = make({width}, 0.2, 1);
  w.ln_b = make({width}, 0.1);
  w.up.weight = make({wide, width}, 0.2);
  w.up.bias = make({wide}, 0.1);
  w.down.weight = make({width, wide}, 0.2);
  w.down.bias = make({width}, 0.1);
  return w;
}

std::vector<at::Tensor> list(const FeedForwardWeights& w) {
  return {w.ln_w, w.ln_b, w.up.weight, w.up.bias, w.down.weight, w.down.bias};
}

TEST(FeedForward, IsItsDefinition) {
  const FeedForwardWeights w = random_weights(8, 12);
  const at::Tensor x = at::randn({5, 8});
  const at::NoGradGuard no_grad;
  const at::Tensor y = feed_forward(w, x, at::kFloat);
  for (std::int64_t r = 0; r < 5; ++r) {
    double mean = 0, variance = 0;
    for (std::int64_t i = 0; i < 8; ++i) mean += x[r][i].item<double>() / 8;
    for (std::int64_t i = 0; i < 8; ++i) variance += std::pow(x[r][i].item<double>() - mean, 2) / 8;
    std::vector<double> normed, wide;
    for (std::int64_t i = 0; i < 8; ++i)
      normed.push_back((x[r][i].item<double>() - mean) / std::sqrt(variance + 1e-5) *
                           w.ln_w[i].item<double>() +
                       w.ln_b[i].item<double>());
    for (std::int64_t j = 0; j < 12; ++j) {
      double sum = w.up.bias[j].item<double>();
      for (std::int64_t i = 0; i < 8; ++i)
        sum += w.up.weight[j][i].item<double>() * normed[static_cast<std::size_t>(i)];
      wide.push_back(0.5 * sum * (1 + std::erf(sum / std::sqrt(2.0))));
    }
    for (std::int64_t i = 0; i < 8; ++i) {
      double sum = x[r][i].item<double>() + w.down.bias[i].item<double>();
      for (std::int64_t j = 0; j < 12; ++j)
        sum += w.down.weight[i][j].item<double>() * wide[static_cast<std::size_t>(j)];
      EXPECT_NEAR(y[r][i].item<double>(), sum, 1e-5);
    }
  }
}

// 300 rows: more than the kernels take at once, and a rest.
TEST(FeedForward, KernelsGiveWhatLibTorchGives) {
  const FeedForwardWeights w = random_weights(64, 128);
  const at::Tensor x = at::randn({300, 64}).requires_grad_(true), dy = at::randn({300, 64});
  const auto run = [&](bool plain) {
    for (at::Tensor t : list(w)) t.mutable_grad() = at::Tensor();
    at::Tensor(x).mutable_grad() = at::Tensor();
    const at::Tensor y =
        plain ? plain_feed_forward(w, x, at::kFloat) : feed_forward(w, x, at::kBFloat16);
    y.backward(dy);
    std::vector<at::Tensor> out = {y.detach(), x.grad()};
    for (const at::Tensor& t : list(w)) out.push_back(t.grad());
    return out;
  };
  const std::vector<at::Tensor> exact = run(true), fast = run(false);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_EQ(fast[i].scalar_type(), at::kFloat);
    const double distance = (fast[i] - exact[i]).norm().item<double>();
    EXPECT_LT(distance, 0.01 * exact[i].norm().item<double>()) << i;
  }
}

}  // namespace

}  // namespace mocaplm::feed_forward_test
