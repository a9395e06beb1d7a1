#include "numeric/histogram.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/random.h"

namespace mocaplm::histogram_test {
namespace {

TEST(Histogram, CountsWithAdditiveSmoothing) {
  Histogram histogram(4, 0.5);
  for (const int value : {1, 1, 3}) histogram.add(value);
  EXPECT_EQ(histogram.total(), 3);
  EXPECT_EQ(histogram.count(1), 2);
  EXPECT_DOUBLE_EQ(histogram.probability(1), 2.5 / 5);
  EXPECT_DOUBLE_EQ(histogram.probability(0), 0.5 / 5);
  EXPECT_DOUBLE_EQ(histogram.bits(1), 1);
}

TEST(Histogram, NothingSeenIsUniformAndProbabilitiesSumToOne) {
  EXPECT_DOUBLE_EQ(Histogram(256).bits(17), 8);
  Random random(1);
  Histogram histogram(37, 0.1);
  for (int i = 0; i < 500; ++i) histogram.add(static_cast<int>(random.below(10)));
  double sum = 0;
  for (int v = 0; v < 37; ++v) sum += histogram.probability(v);
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(Histogram, MeanBitsApproachTheEntropy) {
  Random random(2);
  Histogram histogram(8, 1);
  const auto draw = [&] {
    return random.uniform() < 0.5 ? 0 : random.uniform() < 0.5 ? 1 : 2;
  };  // 1.5 bits
  for (int i = 0; i < 100000; ++i) histogram.add(draw());
  double bits = 0;
  for (int i = 0; i < 100000; ++i) bits += histogram.bits(draw());
  EXPECT_NEAR(bits / 100000, 1.5, 0.01);
}

}  // namespace
}  // namespace mocaplm::histogram_test
