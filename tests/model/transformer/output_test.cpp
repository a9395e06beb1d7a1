// The output layer and its fused cross-entropy against plain loops, log_softmax and differences.
#include "model/transformer/output.h"

#include <ATen/Parallel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/input.h"
#include "support/tensors.h"

namespace mocaplm::output_test {

namespace {

constexpr BinRange kBins{4, 20};
constexpr std::int64_t kVocabulary = 27, kReach = 6, kRows = 300;

struct Case {
  at::Tensor absolute, offsets, centre, target;  // offsets undefined for the plain output
};

// Centres of every kind, inside, far outside and absent; targets of every kind, some ignored.
Case random_case(std::uint64_t seed, bool with_offsets) {
  at::manual_seed(seed);
  Case c;
  c.absolute = at::randn({kRows, kVocabulary}) * 3;
  if (with_offsets) c.offsets = at::randn({kRows, 2 * kReach + 1}) * 3;
  c.centre = at::randint(-15, 40, {kRows}, at::kLong);
  c.target = at::randint(0, kVocabulary, {kRows}, at::kLong);
  for (std::int64_t i = 0; i < kRows; ++i) {
    if (i % 5 == 0) c.centre[i] = kNoCentre;
    if (i % 7 == 0) c.centre[i] = i % 2 == 0 ? 100000 : -100000;
    if (i % 4 == 0) c.target[i] = -1;
  }
  return c;
}

// Bin by bin from the definition in output.h.
at::Tensor plain_logits(const Case& c) {
  at::Tensor out = c.absolute.clone();
  if (!c.offsets.defined()) return out;
  for (std::int64_t i = 0; i < kRows; ++i) {
    const auto centre = c.centre[i].item<std::int64_t>();
    if (centre == kNoCentre) continue;
    for (std::int64_t b = 0; b < kBins.count; ++b) {
      const std::int64_t far = std::max(-kReach, std::min(kReach, b - centre));
      out[i][kBins.first + b] += c.offsets[i][far + kReach];
    }
  }
  return out;
}

TEST(CombinedLogits, AreTheSumBinByBin) {
  for (const bool with_offsets : {true, false}) {
    const Case c = random_case(1, with_offsets);
    const at::Tensor logits = combined_logits(c.absolute, c.offsets, c.centre, kBins);
    EXPECT_LT(largest_difference(logits, plain_logits(c)), 1e-6);
  }
}

// Loss and gradients through `loss_of`, with an upstream gradient of its own for each row.
struct Gradients {
  at::Tensor loss, absolute, offsets;
};

template <class Loss>
Gradients differentiate(const Case& c, at::ScalarType type, const Loss& loss_of) {
  const at::Tensor absolute = c.absolute.to(type).detach().clone().set_requires_grad(true);
  at::Tensor offsets;
  if (c.offsets.defined()) offsets = c.offsets.to(type).detach().clone().set_requires_grad(true);
  const at::Tensor loss = loss_of(absolute, offsets);
  loss.backward(at::linspace(-1, 2, kRows, loss.options()));
  return {loss.detach(), absolute.grad(), offsets.defined() ? offsets.grad() : at::Tensor()};
}

Gradients reference(const Case& c) {
  return differentiate(c, at::kDouble, [&](const at::Tensor& absolute, const at::Tensor& offsets) {
    const at::Tensor logits = combined_logits(absolute, offsets, c.centre, kBins);
    const at::Tensor picked =
        at::log_softmax(logits, -1).gather(1, c.target.clamp_min(0).unsqueeze(1)).squeeze(1);
    return at::where(c.target >= 0, -picked, at::zeros_like(picked));
  });
}

Gradients combined(const Case& c, at::ScalarType type) {
  return differentiate(c, type, [&](const at::Tensor& absolute, const at::Tensor& offsets) {
    return combined_cross_entropy(absolute, offsets, c.centre, c.target, kBins);
  });
}

void expect_close(const Gradients& a, const Gradients& b, double tolerance) {
  EXPECT_LT(largest_difference(a.loss, b.loss), tolerance);
  EXPECT_LT(largest_difference(a.absolute, b.absolute), tolerance);
  ASSERT_EQ(a.offsets.defined(), b.offsets.defined());
  if (!a.offsets.defined()) return;
  EXPECT_LT(largest_difference(a.offsets, b.offsets), tolerance);
}

TEST(CombinedCrossEntropy, FusedPassIsLogSoftmaxWithItsGradients) {
  for (const bool with_offsets : {true, false}) {
    for (std::uint64_t seed = 2; seed < 5; ++seed) {
      const Case c = random_case(seed, with_offsets);
      expect_close(combined(c, at::kFloat), reference(c), 3e-6);
      expect_close(combined(c, at::kDouble), reference(c), 1e-12);  // the other path
    }
  }
}

TEST(CombinedCrossEntropy, GradientsAreThoseOfFiniteDifferences) {
  const Case c = random_case(5, true);
  const Gradients fused = combined(c, at::kFloat);
  const at::Tensor upstream = at::linspace(-1, 2, kRows, at::kDouble);
  const auto total = [&](const at::Tensor& absolute, const at::Tensor& offsets) {
    return (combined_cross_entropy(absolute, offsets, c.centre, c.target, kBins) * upstream)
        .sum()
        .item<double>();
  };
  const at::Tensor absolute = c.absolute.to(at::kDouble), offsets = c.offsets.to(at::kDouble);
  constexpr double kStep = 1e-5;
  for (std::int64_t i = 1; i < kRows; i += 23)
    for (std::int64_t j = 0; j < 2 * kReach + 1; j += 3) {
      at::Tensor up = absolute.clone(), down = absolute.clone();
      up[i][2 * j] += kStep;
      down[i][2 * j] -= kStep;
      EXPECT_NEAR((total(up, offsets) - total(down, offsets)) / (2 * kStep),
                  fused.absolute[i][2 * j].item<double>(), 1e-6);
      up = offsets.clone(), down = offsets.clone();
      up[i][j] += kStep;
      down[i][j] -= kStep;
      EXPECT_NEAR((total(absolute, up) - total(absolute, down)) / (2 * kStep),
                  fused.offsets[i][j].item<double>(), 1e-6);
    }
}

TEST(CombinedCrossEntropy, IgnoredTargetsCostAndTeachNothing) {
  Case c = random_case(6, true);
  c.target.fill_(-1);
  const Gradients g = combined(c, at::kFloat);
  EXPECT_EQ(g.loss.abs().max().item<double>(), 0);
  EXPECT_EQ(g.absolute.abs().max().item<double>(), 0);
  EXPECT_EQ(g.offsets.abs().max().item<double>(), 0);
}

TEST(CombinedCrossEntropy, LargeLogitsDoNotOverflow) {
  Case c = random_case(7, true);
  c.absolute = c.absolute * 1e4;
  const Gradients g = combined(c, at::kFloat), exact = reference(c);
  EXPECT_TRUE(at::isfinite(g.loss).all().item<bool>());
  EXPECT_LT(largest_difference(g.loss, exact.loss), 0.02);
}

TEST(CombinedCrossEntropy, DoesNotDependOnThreads) {
  const Case c = random_case(8, true);
  at::set_num_threads(1);
  const Gradients one = combined(c, at::kFloat);
  at::set_num_threads(3);
  const Gradients three = combined(c, at::kFloat);
  at::set_num_threads(1);
  EXPECT_TRUE(at::equal(one.loss, three.loss));
  EXPECT_TRUE(at::equal(one.absolute, three.absolute));
  EXPECT_TRUE(at::equal(one.offsets, three.offsets));
}

}  // namespace

}  // namespace mocaplm::output_test
