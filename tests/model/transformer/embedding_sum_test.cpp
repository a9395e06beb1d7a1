// One pass against one lookup after the other.
#include "model/transformer/embedding_sum.h"

#include <gtest/gtest.h>

namespace mocaplm::embedding_sum_test {

namespace {

TEST(EmbeddingSum, IsTheSumOfItsLookupsAndSoAreItsGradients) {
  for (const std::int64_t width : {1, 8, 16, 40, 130}) {
    at::manual_seed(static_cast<std::uint64_t>(width));
    const std::int64_t rows = 600;
    at::Tensor base = at::randn({rows, width}).set_requires_grad(true);
    std::vector<Lookup> lookups;
    for (const std::int64_t height : {1, 7, 400})
      lookups.push_back({at::randn({height, width}).set_requires_grad(true),
                         at::randint(height, {rows}, at::kLong)});
    const at::Tensor weight = at::randn({rows, width});
    const auto gradients = [&](const at::Tensor& sum) {
      (sum * weight).sum().backward();
      std::vector<at::Tensor> all = {base.grad().clone()};
      base.mutable_grad().zero_();
      for (const Lookup& one : lookups) {
        all.push_back(one.table.grad().clone());
        one.table.mutable_grad().zero_();
      }
      return all;
    };
    const at::Tensor sum = embedding_sum(base, lookups);
    at::Tensor expected = base;
    for (const Lookup& one : lookups) expected = expected + one.table.index_select(0, one.index);
    EXPECT_TRUE(at::allclose(sum, expected, 1e-5, 1e-6));
    const auto got = gradients(sum), wanted = gradients(expected);
    for (std::size_t i = 0; i < got.size(); ++i)
      EXPECT_TRUE(at::allclose(got[i], wanted[i], 1e-4, 1e-4)) << width << " " << i;
  }
}

TEST(EmbeddingSum, WithoutLookupsIsItsBase) {
  const at::Tensor base = at::randn({5, 3});
  EXPECT_TRUE(at::equal(embedding_sum(base, {}), base));
}

}  // namespace

}  // namespace mocaplm::embedding_sum_test
