// Blocked causal attention against the masked softmax of thesis equation 4.1, forward and backward.
#include "model/transformer/attention.h"

#include <ATen/Parallel.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model/transformer/cpu/attention.h"
#include "model/transformer/cpu/features.h"
#include "model/transformer/dropout.h"
#include "support/tensors.h"

namespace mocaplm::attention_test {

namespace {

// The whole square, and the mask as a table: query t sees keys 0..t, the last `free` see all.
// `kept` multiplies the attention weights (dropout).
at::Tensor plain_attention(const at::Tensor& q, const at::Tensor& k, const at::Tensor& v,
                           std::int64_t free, const at::Tensor& kept = {}) {
  const std::int64_t length = q.size(2);
  at::Tensor hidden = at::zeros({length, length}, at::kBool);
  for (std::int64_t t = 0; t < length - free; ++t)
    for (std::int64_t s = t + 1; s < length; ++s) hidden[t][s] = true;
  at::Tensor scores = at::matmul(q, k.transpose(2, 3)) / std::sqrt(static_cast<double>(q.size(3)));
  scores = scores.masked_fill(hidden, -std::numeric_limits<double>::infinity());
  at::Tensor weights = at::softmax(scores, -1);
  if (kept.defined()) weights = weights * kept;
  return at::matmul(weights, v);
}

struct Result {
  at::Tensor out, dq, dk, dv;
};

template <class Attention>
Result run(const Attention& attention, const at::Tensor& qkv, const at::Tensor& upstream) {
  const at::Tensor q = qkv[0].detach().clone().set_requires_grad(true),
                   k = qkv[1].detach().clone().set_requires_grad(true),
                   v = qkv[2].detach().clone().set_requires_grad(true);
  const at::Tensor out = attention(q, k, v);
  out.backward(upstream);
  return {out.detach(), q.grad(), k.grad(), v.grad()};
}

void expect_close(const Result& a, const Result& b, double tolerance) {
  EXPECT_LT(largest_difference(a.out, b.out), tolerance) << "forward";
  EXPECT_LT(largest_difference(a.dq, b.dq), tolerance) << "gradient of the queries";
  EXPECT_LT(largest_difference(a.dk, b.dk), tolerance) << "gradient of the keys";
  EXPECT_LT(largest_difference(a.dv, b.dv), tolerance) << "gradient of the values";
}

void compare(std::int64_t length, std::int64_t free, at::ScalarType type, double tolerance) {
  SCOPED_TRACE("length " + std::to_string(length) + ", free " + std::to_string(free));
  at::manual_seed(static_cast<std::uint64_t>(100 * length + free));
  const at::Tensor qkv = at::randn({3, 2, 3, length, 5}).to(type);
  const at::Tensor upstream = at::randn({2, 3, length, 5}).to(type);
  const Result plain = run([&](const at::Tensor& q, const at::Tensor& k,
                               const at::Tensor& v) { return plain_attention(q, k, v, free); },
                           qkv.to(at::kDouble), upstream.to(at::kDouble));
  const Result blocked =
      run([&](const at::Tensor& q, const at::Tensor& k,
              const at::Tensor& v) { return causal_attention(q, k, v, free, 0); },
          qkv, upstream);
  EXPECT_EQ(blocked.out.scalar_type(), type);
  expect_close(blocked, plain, tolerance);
}

TEST(CausalAttention, IsTheMaskedSoftmaxAtEveryLength) {
  for (const std::int64_t length : {1, 2, 31, 127, 128, 129, 256, 300})
    compare(length, 0, at::kFloat, 2e-5);
}

TEST(CausalAttention, FreeQueriesSeeEverything) {
  for (const std::int64_t length : {3, 31, 128, 129, 130, 131, 256, 300}) {
    compare(length, 1, at::kFloat, 2e-5);
    compare(length, 2, at::kFloat, 2e-5);
  }
  compare(300, 140, at::kFloat, 2e-5);  // more free queries than a block has
  compare(300, 300, at::kFloat, 2e-5);  // a masked model: no causality at all
  compare(20, 20, at::kFloat, 2e-5);
}

TEST(CausalAttention, IsExactInDoublePrecision) {
  compare(300, 0, at::kDouble, 1e-12);
  compare(300, 2, at::kDouble, 1e-12);
}

TEST(CausalAttention, IsCloseInBf16) {
  compare(200, 0, at::kBFloat16, 0.1);
  compare(200, 2, at::kBFloat16, 0.1);
}

// qkv (B, T, 3, H, D) in bf16 through the packed function, the same values in double through the
// plain one. `kept` (B, H, T, T) are factors of dropout.
void compare_packed(std::int64_t length, std::int64_t width, std::int64_t free, double dropout = 0,
                    const at::Tensor& kept = {}) {
  SCOPED_TRACE("length " + std::to_string(length) + ", width " + std::to_string(width) + ", free " +
               std::to_string(free));
  at::manual_seed(static_cast<std::uint64_t>(100 * length + width));
  const at::Tensor qkv = at::randn({2, length, 3, 3, width}).to(at::kBFloat16);
  const at::Tensor upstream = at::randn({2, length, 3, width}).to(at::kBFloat16);
  const at::Tensor ours = qkv.clone().set_requires_grad(true);
  const at::Tensor exact = qkv.to(at::kDouble).set_requires_grad(true);
  at::manual_seed(9);
  const at::Tensor out = packed_causal_attention(ours, free, dropout);
  const at::Tensor turned = exact.permute({2, 0, 3, 1, 4});
  const at::Tensor expected =
      plain_attention(turned[0], turned[1], turned[2], free, kept).transpose(1, 2);
  out.backward(upstream);
  expected.backward(upstream.to(at::kDouble));
  // bf16 has 8 bits: each of its roundings is at most 0.4 % of the value.
  const auto close = [](const at::Tensor& a, const at::Tensor& b, const char* what) {
    // Few values scatter more about the mean.
    const double share = 0.006 + 0.02 / std::sqrt(static_cast<double>(a.numel()));
    const at::Tensor difference = (a.detach().to(at::kDouble) - b.detach()).abs();
    EXPECT_LT(difference.max().item<double>(), 0.02 * b.abs().max().item<double>() + 1e-5) << what;
    EXPECT_LT(difference.square().mean().sqrt().item<double>(),
              share * b.detach().square().mean().sqrt().item<double>() + 1e-4)
        << what;
  };
  EXPECT_EQ(out.scalar_type(), at::kBFloat16);
  close(out, expected, "forward");
  for (std::int64_t i = 0; i < 3; ++i)
    close(ours.grad().select(2, i), exact.grad().select(2, i),
          i == 0   ? "gradient of the queries"
          : i == 1 ? "of the keys"
                   : "of the values");
}

TEST(PackedAttention, IsTheMaskedSoftmaxAtEveryLengthAndWidth) {
  for (const std::int64_t length : {1, 2, 31, 48, 63, 64, 65, 128, 130, 257})
    for (const std::int64_t width : {2, 16, 24, 32, 48, 64, 80}) compare_packed(length, width, 0);
}

TEST(PackedAttention, FreeQueriesSeeEverything) {
  for (const std::int64_t length : {3, 31, 64, 65, 66, 129, 130, 131, 200})
    for (const std::int64_t free : {1, 2, 3}) compare_packed(length, 32, free);
  compare_packed(200, 48, 100);
  compare_packed(20, 48, 20);
  compare_packed(257, 32, 257);  // a masked model
}

TEST(PackedAttention, OtherProcessorsGetTheSame) {
  cpu::allow_avx512(false);
  compare_packed(130, 24, 0);
  compare_packed(130, 24, 2);
  cpu::allow_avx512(true);
  compare_packed(130, 7, 0);  // an odd width is left to LibTorch
}

TEST(PackedAttention, DropoutIsTheSameForwardAndBackward) {
  if (!cpu::attention_available(32)) GTEST_SKIP() << "this processor has no AVX512_BF16";
  const std::int64_t length = 140;
  at::manual_seed(9);
  const cpu::AttentionShape shape{2, length, 3, 32, 1, 0.3, random_seed()};
  at::Tensor kept = at::empty({2, 3, length, length}, at::kDouble);
  for (std::int64_t i = 0; i < kept.numel(); ++i)
    kept.data_ptr<double>()[i] =
        cpu::dropout_factor(shape, i / (length * length), i / length % length, i % length);
  EXPECT_NEAR((kept == 0).to(at::kDouble).mean().item<double>(), 0.3, 0.01);
  EXPECT_NEAR(kept.mean().item<double>(), 1, 0.01);
  compare_packed(length, 32, 1, 0.3, kept);
}

TEST(PackedAttention, DoesNotDependOnTheThreads) {
  at::manual_seed(1);
  const at::Tensor qkv = at::randn({3, 150, 3, 2, 32}).to(at::kBFloat16);
  const auto results = [&](int threads) {
    at::set_num_threads(threads);
    const at::Tensor x = qkv.clone().set_requires_grad(true);
    const at::Tensor out = packed_causal_attention(x, 0, 0);
    out.backward(at::ones_like(out));
    return std::make_pair(out.detach(), x.grad());
  };
  const auto one = results(1), three = results(3);
  at::set_num_threads(1);
  EXPECT_TRUE(at::equal(one.first, three.first));
  EXPECT_TRUE(at::equal(one.second, three.second));
}

TEST(CausalAttention, LargeScoresDoNotOverflow) {
  const at::Tensor q = at::full({1, 1, 140, 4}, 1e4);
  const at::Tensor v = at::arange(140 * 4, at::kFloat).view({1, 1, 140, 4});
  const at::Tensor out = causal_attention(q, q, v, 0, 0);
  EXPECT_TRUE(at::isfinite(out).all().item<bool>());
  EXPECT_LT(largest_difference(out[0][0][139], v[0][0].mean(0)), 1e-2);  // all keys alike
}

TEST(CausalAttention, DropoutActsOnTheWeightsForwardAndBackward) {
  const std::int64_t length = 60;  // one block, so that one mask is drawn
  const double p = 0.3;
  at::manual_seed(4);
  const at::Tensor qkv = at::randn({3, 2, 2, length, 6}), upstream = at::randn({2, 2, length, 6});
  at::manual_seed(5);
  const Result dropped = run([&](const at::Tensor& q, const at::Tensor& k,
                                 const at::Tensor& v) { return causal_attention(q, k, v, 0, p); },
                             qkv, upstream);
  at::manual_seed(5);
  const at::Tensor kept = dropout_mask(at::empty({2, 2, length, length}), p);
  const Result plain = run([&](const at::Tensor& q, const at::Tensor& k,
                               const at::Tensor& v) { return plain_attention(q, k, v, 0, kept); },
                           qkv, upstream);
  expect_close(dropped, plain, 2e-5);
}

TEST(DropoutMask, HasTheRightShareAndScale) {
  at::manual_seed(1);
  for (const double p : {0.1, 0.5, 0.9}) {
    for (const at::ScalarType type : {at::kFloat, at::kBFloat16}) {
      const at::Tensor mask = dropout_mask(at::empty({1000, 257}, type), p).to(at::kDouble);
      const double count = static_cast<double>(mask.numel());
      const double zeros = (mask == 0).sum().item<double>() / count;
      EXPECT_NEAR(zeros, p, 5 * std::sqrt(p * (1 - p) / count));
      const at::Tensor rest = mask.masked_select(mask != 0);
      EXPECT_NEAR(rest.min().item<double>() * (1 - p), 1, 5e-3);
      EXPECT_EQ(rest.min().item<double>(), rest.max().item<double>());
      EXPECT_NEAR(mask.mean().item<double>(), 1, 0.02);
    }
  }
}

TEST(DropoutMask, NeighboursAreIndependent) {
  at::manual_seed(2);
  const at::Tensor kept = (dropout_mask(at::empty({1 << 18}), 0.5) != 0).to(at::kDouble) - 0.5;
  for (const std::int64_t lag : {1, 2, 3, 4, 5, 8, 64, 192, 1024}) {
    const at::Tensor product = kept.slice(0, lag) * kept.slice(0, 0, kept.size(0) - lag) * 4;
    EXPECT_LT(std::abs(product.mean().item<double>()), 5 / 512.0) << "lag " << lag;
  }
  const at::Tensor other = (dropout_mask(at::empty({1 << 18}), 0.5) != 0).to(at::kDouble) - 0.5;
  EXPECT_LT(std::abs((kept * other * 4).mean().item<double>()), 5 / 512.0) << "two calls";
}

TEST(DropoutMask, FollowsTheSeedAndNotTheThreads) {
  const auto draw = [](std::uint64_t seed) {
    at::manual_seed(seed);
    return dropout_mask(at::empty({333, 1001}), 0.2);
  };
  at::set_num_threads(1);
  const at::Tensor one = draw(7);
  at::set_num_threads(3);
  EXPECT_TRUE(at::equal(draw(7), one));
  EXPECT_FALSE(at::equal(draw(8), one));
  at::set_num_threads(1);
}

TEST(DropoutMask, IsContiguousWhateverItIsLike) {
  at::manual_seed(3);
  const at::Tensor mask = dropout_mask(at::empty({4, 6}).transpose(0, 1), 0.5);
  EXPECT_TRUE(mask.is_contiguous());
  EXPECT_EQ(mask.sizes(), at::IntArrayRef({6, 4}));
}

}  // namespace

}  // namespace mocaplm::attention_test
