// The pointwise kernels against their formulas, and the choice of a level.
#include "generate/kernels/kernels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/kernel_levels.h"
#include "support/random_numbers.h"

namespace mocaplm::kernels_test {

namespace {

class Pointwise : public EveryKernel {};
INSTANTIATE_TEST_SUITE_P(Levels, Pointwise, all_levels(), level_name);

TEST_P(Pointwise, LayerNormIsItsFormula) {
  Random random(5);
  for (const std::int64_t width : {1, 5, 37, 128, 515}) {
    const std::int64_t rows = 3;
    // Far from 0, where a careless variance loses everything.
    const auto x = normal_numbers(random, rows * width, 1000, 3),
               weight = normal_numbers(random, width), bias = normal_numbers(random, width);
    std::vector<float> y(x.size());
    kernels().layer_norm(x.data(), weight.data(), bias.data(), rows, width, y.data());
    for (std::int64_t r = 0; r < rows; ++r) {
      const float *row = x.data() + r * width, *out = y.data() + r * width;
      double mean = 0, square = 0;
      for (std::int64_t i = 0; i < width; ++i) mean += row[i] / static_cast<double>(width);
      for (std::int64_t i = 0; i < width; ++i)
        square += (row[i] - mean) * (row[i] - mean) / static_cast<double>(width);
      for (std::int64_t i = 0; i < width; ++i) {
        const auto at = static_cast<std::size_t>(i);
        ASSERT_NEAR(out[i], (row[i] - mean) / std::sqrt(square + 1e-5) * weight[at] + bias[at],
                    2e-4);
      }
    }
  }
}

TEST_P(Pointwise, GeluIsItsFormula) {
  std::vector<float> v;
  for (double value = -30; value <= 30; value += 0.01) v.push_back(static_cast<float>(value));
  const std::vector<float> none(v.size(), 0.f);
  std::vector<float> g(v.size());
  kernels().store_gelu(v.data(), nullptr, 1, none.data(), static_cast<std::int64_t>(v.size()),
                       g.data());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double z = v[i];
    ASSERT_NEAR(g[i], 0.5 * z * (1 + std::erf(z / std::sqrt(2.0))), 1e-6 * (1 + std::abs(z))) << z;
  }
}

TEST(Level, OneThatTheProcessorLacksIsNotTaken) {
  set_kernel_level(KernelLevel::avx512_bf16);
  EXPECT_EQ(kernel_level(), best_kernel_level());
  set_kernel_level(KernelLevel::plain);
  EXPECT_EQ(kernel_level(), KernelLevel::plain);
  EXPECT_EQ(&kernels(), &kPlainKernels);
  set_kernel_level(best_kernel_level());
}

}  // namespace

}  // namespace mocaplm::kernels_test
