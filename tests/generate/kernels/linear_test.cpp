// Packed layers against plain sums over the values that they keep.
#include "generate/kernels/linear.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "support/kernel_levels.h"
#include "support/random_numbers.h"

namespace mocaplm::linear_test {

namespace {

class Linear : public EveryKernel {};
INSTANTIATE_TEST_SUITE_P(Levels, Linear, all_levels(), level_name);

float rounded(float value) {
  const auto bits = static_cast<std::uint32_t>(to_bf16(value)) << 16;
  float out;
  std::memcpy(&out, &bits, sizeof out);
  return out;
}

// What a row or an output's weights become in 8 bits.
std::vector<float> in_8_bits(const float* values, std::int64_t count) {
  float top = 0;
  for (std::int64_t i = 0; i < count; ++i) top = std::max(top, std::abs(values[i]));
  std::vector<float> out;
  for (std::int64_t i = 0; i < count; ++i)
    out.push_back(top == 0 ? 0 : std::round(values[i] / top * 127) * top / 127);
  return out;
}

std::vector<float> kept(Precision precision, const float* values, std::int64_t count) {
  if (precision == Precision::int8) return in_8_bits(values, count);
  std::vector<float> out(values, values + count);
  if (precision == Precision::bf16)
    for (float& value : out) value = rounded(value);
  return out;
}

struct Case {
  std::int64_t out, in, rows;
  std::vector<float> weight, bias, x;
};

Case random_case(std::int64_t out, std::int64_t in, std::int64_t rows, Random& random) {
  return {out,
          in,
          rows,
          normal_numbers(random, out * in),
          normal_numbers(random, out),
          normal_numbers(random, rows * in)};
}

// Rows are rounded too where the processor multiplies pairs of bf16; elsewhere they stay as they
// are, and `slack` allows for the difference.
void expect_product(const Case& c, Precision precision) {
  Arena arena;
  const PackedLinear linear(c.weight.data(), c.bias.data(), c.out, c.in, precision, arena);
  LinearScratch scratch(c.in);
  std::vector<float> y(static_cast<std::size_t>(c.rows * c.out + 8), 77.f);
  for (const int part : {1, 0, 2})  // every part writes its own share
    linear.apply(c.x.data(), y.data(), c.rows, Store::plain, scratch, part, 3);
  const bool pairs = kernel_level() == KernelLevel::avx512_bf16;
  for (std::int64_t r = 0; r < c.rows; ++r) {
    const float* row = c.x.data() + r * c.in;
    const std::vector<float> x = precision == Precision::bf16 && !pairs
                                     ? std::vector<float>(row, row + c.in)
                                     : kept(precision, row, c.in);
    for (std::int64_t o = 0; o < c.out; ++o) {
      const std::vector<float> w = kept(precision, c.weight.data() + o * c.in, c.in);
      double sum = c.bias[static_cast<std::size_t>(o)], size = 1;
      for (std::size_t k = 0; k < w.size(); ++k) {
        sum += static_cast<double>(x[k]) * w[k];
        size += std::abs(static_cast<double>(x[k]) * w[k]);
      }
      // A value half way between two 8-bit numbers may go either way.
      const double slack = precision == Precision::int8 ? 4e-4 : 3e-6;
      ASSERT_NEAR(y[static_cast<std::size_t>(r * c.out + o)], sum, slack * size)
          << to_string(precision) << " " << c.out << " x " << c.in << ", row " << r << " of "
          << c.rows << ", output " << o;
    }
  }
  for (std::int64_t i = c.rows * c.out; i < c.rows * c.out + 8; ++i)
    ASSERT_EQ(y[static_cast<std::size_t>(i)], 77.f) << "written past the end";
}

TEST_P(Linear, IsTheMatrixProduct) {
  Random random(3);
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8})
    for (const std::int64_t out : {1, 63, 64, 65, 200})
      for (const std::int64_t in : {1, 2, 3, 7, 64, 129, 514})
        for (const std::int64_t rows : {1, 2, 3, 5, 6, 7, 14}) {
          expect_product(random_case(out, in, rows, random), precision);
          if (HasFatalFailure()) return;
        }
}

TEST_P(Linear, ExtremesOfEightBitsDoNotOverflow) {
  Random random(4);
  Case c = random_case(64, 2048, 2, random);
  for (std::size_t i = 0; i < c.weight.size(); ++i) c.weight[i] = i % 2 == 0 ? 1.f : -1.f;
  for (std::size_t i = 0; i < c.x.size(); ++i) c.x[i] = i % 2 == 0 ? 2.f : -2.f;
  expect_product(c, Precision::int8);
  for (float& value : c.x) value = -value;
  expect_product(c, Precision::int8);
}

TEST_P(Linear, ZeroRowsAndZeroWeightsGiveTheBias) {
  Random random(5);
  Case c = random_case(70, 40, 3, random);
  std::fill(c.x.begin(), c.x.begin() + 40, 0.f);
  std::fill(c.weight.begin() + 80, c.weight.begin() + 120, 0.f);
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8})
    expect_product(c, precision);
}

// Results must not depend on how many rows go together, or on the parts.
TEST_P(Linear, ARowIsTheSameAloneAndAmongOthers) {
  Random random(6);
  const Case c = random_case(130, 96, 23, random);
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
    Arena arena;
    const PackedLinear linear(c.weight.data(), c.bias.data(), c.out, c.in, precision, arena);
    LinearScratch scratch(c.in);
    std::vector<float> together(static_cast<std::size_t>(c.rows * c.out)),
        alone(static_cast<std::size_t>(c.out));
    linear.apply(c.x.data(), together.data(), c.rows, Store::plain, scratch);
    for (std::int64_t r = 0; r < c.rows; ++r) {
      linear.apply(c.x.data() + r * c.in, alone.data(), 1, Store::plain, scratch);
      for (std::int64_t o = 0; o < c.out; ++o)
        ASSERT_EQ(alone[static_cast<std::size_t>(o)],
                  together[static_cast<std::size_t>(r * c.out + o)]);
    }
  }
}

TEST_P(Linear, StoresGeluAndSums) {
  Random random(7);
  const Case c = random_case(90, 33, 4, random);
  for (const Precision precision : {Precision::f32, Precision::int8}) {
    Arena arena;
    const PackedLinear linear(c.weight.data(), c.bias.data(), c.out, c.in, precision, arena);
    LinearScratch scratch(c.in);
    const auto size = static_cast<std::size_t>(c.rows * c.out);
    std::vector<float> plain(size), gelu(size), sum = normal_numbers(random, c.rows * c.out);
    const std::vector<float> before = sum;
    linear.apply(c.x.data(), plain.data(), c.rows, Store::plain, scratch);
    linear.apply(c.x.data(), gelu.data(), c.rows, Store::gelu, scratch);
    linear.apply(c.x.data(), sum.data(), c.rows, Store::sum, scratch);
    for (std::size_t i = 0; i < size; ++i) {
      const double v = plain[i];
      ASSERT_NEAR(gelu[i], 0.5 * v * (1 + std::erf(v / std::sqrt(2.0))), 1e-5);
      ASSERT_NEAR(sum[i], before[i] + v, 1e-5);
    }
  }
}

TEST(Bf16, RoundsToTheNearestAndTiesToEven) {
  Random random(8);
  for (int i = 0; i < 10000; ++i) {
    const auto value = static_cast<float>(std::exp(6 * random.normal()) * random.normal());
    ASSERT_LE(std::abs(rounded(value) - value), std::abs(value) / 256);
  }
  EXPECT_EQ(to_bf16(1.f), 0x3f80);
  EXPECT_EQ(to_bf16(1.f + 1.f / 256), 0x3f80);  // half way: the even one
  EXPECT_EQ(to_bf16(1.f + 3.f / 256), 0x3f82);
  EXPECT_EQ(to_bf16(-2.f), 0xc000);
}

}  // namespace

}  // namespace mocaplm::linear_test
