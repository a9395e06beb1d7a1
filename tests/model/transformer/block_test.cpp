// The fused transformer block and output layer against LibTorch's operations, forward and backward.
#include "model/transformer/block.h"

#include <ATen/Parallel.h>
#include <gtest/gtest.h>

#include "model/transformer/cpu/block.h"
#include "model/transformer/cpu/features.h"

namespace mocaplm::block_test {

namespace {

at::Tensor leaf(at::IntArrayRef shape, double deviation, double mean = 0) {
  return (at::randn(shape) * deviation + mean).set_requires_grad(true);
}

LinearWeights random_linear(std::int64_t out, std::int64_t in) {
  LinearWeights w;
  w.weight = leaf({out, in}, 1 / std::sqrt(static_cast<double>(in)));
  w.bias = leaf({out}, 0.2);
  return w;
}

BlockWeights random_block(std::int64_t width) {
  BlockWeights w;
  w.ln1_w = leaf({width}, 0.2, 1), w.ln1_b = leaf({width}, 0.1);
  w.qkv = random_linear(3 * width, width);
  w.proj = random_linear(width, width);
  w.ln2_w = leaf({width}, 0.2, 1), w.ln2_b = leaf({width}, 0.1);
  w.up = random_linear(4 * width, width);
  w.down = random_linear(width, 4 * width);
  return w;
}

std::vector<std::pair<std::string, at::Tensor>> named(const BlockWeights& w) {
  return {{"ln1.weight", w.ln1_w},  {"ln1.bias", w.ln1_b},          {"qkv.weight", w.qkv.weight},
          {"qkv.bias", w.qkv.bias}, {"proj.weight", w.proj.weight}, {"proj.bias", w.proj.bias},
          {"ln2.weight", w.ln2_w},  {"ln2.bias", w.ln2_b},          {"up.weight", w.up.weight},
          {"up.bias", w.up.bias},   {"down.weight", w.down.weight}, {"down.bias", w.down.bias}};
}

using Results = std::vector<std::pair<std::string, at::Tensor>>;

// The output and every gradient; one seed for the dropout.
template <class Block>
Results run(const Block& block, const BlockWeights& w, const at::Tensor& input,
            const at::Tensor& upstream, const BlockOptions& options) {
  for (auto& [name, tensor] : named(w)) tensor.mutable_grad() = at::Tensor();
  const at::Tensor x = input.clone().set_requires_grad(true);
  at::manual_seed(77);
  const at::Tensor out = block(w, x, options);
  out.backward(upstream);
  Results results = {{"output", out.detach()}, {"input", x.grad()}};
  for (const auto& [name, tensor] : named(w)) results.emplace_back(name, tensor.grad().clone());
  return results;
}

// Root mean square of the difference over that of b.
double distance(const at::Tensor& a, const at::Tensor& b) {
  return ((a - b).square().sum() / b.square().sum().clamp_min(1e-30)).sqrt().item<double>();
}

void expect_close(const Results& a, const Results& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].second.sizes(), b[i].second.sizes()) << a[i].first;
    EXPECT_LT(distance(a[i].second, b[i].second), tolerance) << a[i].first;
  }
}

struct Size {
  std::int64_t batch, length, width, heads;
};

void compare(const Size& s, std::int64_t free, double dropout) {
  SCOPED_TRACE("B " + std::to_string(s.batch) + ", T " + std::to_string(s.length) + ", C " +
               std::to_string(s.width) + ", H " + std::to_string(s.heads) + ", free " +
               std::to_string(free) + ", dropout " + std::to_string(dropout));
  at::manual_seed(static_cast<std::uint64_t>(s.length * 1000 + s.width));
  const BlockWeights w = random_block(s.width);
  const at::Tensor x = at::randn({s.batch, s.length, s.width}),
                   upstream = at::randn({s.batch, s.length, s.width});
  const BlockOptions options{s.heads, free, dropout, at::kBFloat16};
  const Results fused = run(transformer_block, w, x, upstream, options);
  // bf16 has 8 bits: a rounding is off by at most 0.4 %, and a value goes through a dozen.
  expect_close(fused, run(plain_block, w, x, upstream, options), 0.02);
  if (dropout > 0) return;
  const Results exact = run(plain_block, w, x, upstream, {s.heads, free, 0, at::kFloat});
  expect_close(fused, exact, 0.02);
}

class FusedBlock : public testing::Test {
 protected:
  void SetUp() override {
    if (!cpu::block_available(64, 4)) GTEST_SKIP() << "this processor has no AVX512_BF16";
  }
  void TearDown() override { at::set_num_threads(1); }
};

TEST_F(FusedBlock, IsThePlainOneAtEverySize) {
  for (const Size& s : std::vector<Size>{{1, 1, 16, 2},
                                         {2, 31, 16, 1},
                                         {3, 43, 48, 3},
                                         {1, 127, 64, 4},
                                         {2, 129, 80, 5},
                                         {3, 171, 144, 3},
                                         {1, 300, 192, 4},
                                         {1, 260, 576, 9}})
    compare(s, 0, 0);
}

TEST_F(FusedBlock, FreePositionsSeeEverything) {
  compare({2, 70, 48, 3}, 2, 0);
  compare({1, 131, 64, 2}, 1, 0);
}

TEST_F(FusedBlock, DropsWhatThePlainOneDrops) {
  compare({2, 70, 48, 3}, 0, 0.1);
  compare({1, 131, 80, 5}, 2, 0.5);
}

TEST_F(FusedBlock, WithoutGradientsItGivesTheSame) {
  at::manual_seed(1);
  const BlockWeights w = random_block(48);
  const at::Tensor x = at::randn({2, 40, 48});
  const BlockOptions options{3, 0, 0, at::kBFloat16};
  const at::Tensor with = transformer_block(w, x, options);
  EXPECT_TRUE(with.requires_grad());
  const at::NoGradGuard no_grad;
  EXPECT_TRUE(at::equal(transformer_block(w, x, options), with));
}

TEST_F(FusedBlock, SeesChangedWeights) {
  at::manual_seed(2);
  const BlockWeights w = random_block(32);
  const at::Tensor x = at::randn({1, 20, 32}), upstream = at::randn({1, 20, 32});
  const BlockOptions options{2, 0, 0, at::kBFloat16};
  run(transformer_block, w, x, upstream, options);
  {
    const at::NoGradGuard no_grad;
    for (auto& [name, tensor] : named(w)) tensor.add_(at::randn_like(tensor) * 0.3);
  }
  expect_close(run(transformer_block, w, x, upstream, options),
               run(plain_block, w, x, upstream, options), 0.02);
}

TEST_F(FusedBlock, GradientsOfSeveralBatchesAddUp) {
  at::manual_seed(3);
  const BlockWeights w = random_block(32);
  const at::Tensor x = at::randn({1, 20, 32}), upstream = at::randn({1, 20, 32});
  const BlockOptions options{2, 0, 0, at::kBFloat16};
  const Results once = run(transformer_block, w, x, upstream, options);
  transformer_block(w, x, options).backward(upstream);
  transformer_block(w, x, options).backward(upstream);
  const auto weights = named(w);
  for (std::size_t i = 0; i < weights.size(); ++i)
    EXPECT_LT(distance(weights[i].second.grad(), 3 * once[i + 2].second), 1e-5) << weights[i].first;
}

TEST_F(FusedBlock, DoesNotDependOnTheThreads) {
  at::manual_seed(4);
  const BlockWeights w = random_block(144);
  const at::Tensor x = at::randn({3, 150, 144}), upstream = at::randn({3, 150, 144});
  const BlockOptions options{3, 0, 0.2, at::kBFloat16};
  at::set_num_threads(1);
  const Results one = run(transformer_block, w, x, upstream, options);
  at::set_num_threads(3);
  const Results three = run(transformer_block, w, x, upstream, options);
  for (std::size_t i = 0; i < one.size(); ++i)
    EXPECT_TRUE(at::equal(one[i].second, three[i].second)) << one[i].first;
}

TEST_F(FusedBlock, OtherProcessorsAndPrecisionsGetThePlainOne) {
  at::manual_seed(5);
  const BlockWeights w = random_block(32), odd = random_block(36);  // no multiple of 16
  const at::Tensor x = at::randn({1, 20, 32}), x36 = at::randn({1, 20, 36});
  const BlockOptions f32{2, 0, 0, at::kFloat}, bf16{2, 0, 0, at::kBFloat16};
  EXPECT_TRUE(at::equal(transformer_block(w, x, f32), plain_block(w, x, f32)));
  EXPECT_TRUE(at::equal(transformer_block(odd, x36, bf16), plain_block(odd, x36, bf16)));
  cpu::allow_avx512(false);
  EXPECT_TRUE(at::equal(transformer_block(w, x, bf16), plain_block(w, x, bf16)));
  cpu::allow_avx512(true);
  EXPECT_FALSE(at::equal(transformer_block(w, x, bf16), plain_block(w, x, bf16)));
}

TEST_F(FusedBlock, TheOutputLayerIsThePlainOneAtEverySize) {
  for (const auto& [rows, width, outputs] : std::vector<std::array<std::int64_t, 3>>{
           {1, 16, 1}, {70, 48, 37}, {257, 64, 121}, {130, 512, 364}}) {
    SCOPED_TRACE(std::to_string(rows) + " x " + std::to_string(width) + " x " +
                 std::to_string(outputs));
    at::manual_seed(6);
    const LinearWeights w = random_linear(outputs, width);
    const at::Tensor input = at::randn({rows, width}), upstream = at::randn({rows, outputs});
    std::vector<std::vector<at::Tensor>> results;
    for (const at::ScalarType type : {at::kBFloat16, at::kFloat}) {
      const at::Tensor x = input.clone().set_requires_grad(true);
      w.weight.mutable_grad() = w.bias.mutable_grad() = at::Tensor();
      const at::Tensor out = output_linear(w, x, type);
      out.backward(upstream);
      results.push_back({out.detach(), x.grad(), w.weight.grad(), w.bias.grad()});
    }
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT(distance(results[0][i], results[1][i]), 0.01) << i;
      EXPECT_EQ(results[0][i].scalar_type(), at::kFloat);
    }
  }
}

}  // namespace

}  // namespace mocaplm::block_test
