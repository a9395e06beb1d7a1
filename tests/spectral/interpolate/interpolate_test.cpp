#include "spectral/interpolate/interpolate.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "numeric/dct.h"
#include "spectral/measures.h"
#include "spectral/unwound.h"
#include "support/refusal.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::interpolate_test {
namespace {

InterpolateConfig config_of(const std::string& target) {
  InterpolateConfig config;
  config.target = target;
  config.fps = 20;
  config.stft_window = 8;
  config.coefficients = 8;
  return config;
}

// The descent's end is known: the weighted mean of both inside the range, A outside of it.
TEST(Interpolate, DctMeetsTheWeightedMean) {
  const Clip a = random_clip(1, 50, 20), b = random_clip(2, 60, 20);
  InterpolateConfig config = config_of("dct");
  config.weight = 0.7;
  config.from_hz = 0.4;
  config.to_hz = 2;  // coefficients 2 to 10 of 50, 0.2 Hz each
  const InterpolateResult result = interpolate(a, b, config);
  ASSERT_EQ(result.result.frames(), 50);
  EXPECT_EQ(result.features, 9 * 72);
  const Eigen::MatrixXd dct = dct_matrix(50);
  Eigen::MatrixXd wanted = dct * result.original.poses;
  wanted.middleRows(2, 9) =
      0.7 * dct.middleRows(2, 9) * result.target.poses + 0.3 * wanted.middleRows(2, 9).eval();
  Clip exact = result.original;
  exact.poses = dct.transpose() * wanted;
  EXPECT_LT(angle_apart(exact, result.result).most, 1e-3);
  EXPECT_NEAR(result.error_after, 0.09 * result.error_before, 1e-3 * result.error_before);
  EXPECT_EQ(result.result.trans, result.original.trans);
}

TEST(Interpolate, LiesBetweenBoth) {
  const Clip a = random_clip(3, 80, 20), b = random_clip(4, 80, 20);
  for (const char* target : {"dct", "pca", "stft", "own_pca"}) {
    InterpolateConfig config = config_of(target);
    config.to_hz = 10;
    const InterpolateResult result = interpolate(a, b, config);
    EXPECT_LT(result.error_after, 0.8 * result.error_before) << target;
    EXPECT_GT(result.stft.result_target, result.stft.original_target) << target;
    EXPECT_GT(result.stft.result_original, result.stft.original_target) << target;
    check_clip(result.result, target);
    EXPECT_EQ(interpolate_table(result, config).rows().size(), 3u);
  }
}

// All frequencies and the target's weight alone: the target itself.
TEST(Interpolate, MayArriveAtTheTarget) {
  const Clip a = random_clip(5, 40, 20), b = random_clip(6, 40, 20);
  InterpolateConfig config = config_of("dct");
  config.weight = 1;
  config.rate = 1;
  config.steps = 2;
  config.to_hz = 10;
  const InterpolateResult result = interpolate(a, b, config);
  EXPECT_LT(angle_apart(result.target, result.result).most, 1e-3);
  EXPECT_NEAR(result.dct.result_target, 1, 1e-9);
  config.steps = 0;
  EXPECT_LT(angle_apart(result.original, interpolate(a, b, config).result).most, 1e-5);
}

// A step's gradient by finite differences: what one small step changes of the loss.
TEST(Interpolate, StepsGoDownhillByTheGradientsSquare) {
  const Clip a = random_clip(7, 40, 20), b = random_clip(8, 40, 20);
  for (const char* target : {"dct", "pca", "stft"}) {
    InterpolateConfig config = config_of(target);
    config.weight = 1;
    config.steps = 1;
    config.rate = 1e-4;
    const InterpolateResult result = interpolate(a, b, config);
    const double n = static_cast<double>(result.features);
    const Eigen::MatrixXd step = unwound(result.result).poses - result.original.poses;
    // x - rate g / 2 with loss' = g: the loss falls by |step|^2 2 / rate to first order.
    const double fell = n * (result.error_before - result.error_after);
    EXPECT_NEAR(fell, 2 * step.squaredNorm() / config.rate, 2e-3 * fell) << target;
  }
}

// The components move with the motion, their slopes are large where two are nearly as strong.
TEST(Interpolate, OwnComponentsGoDownhillByTheGradientsSquare) {
  const Clip a = random_clip(7, 90, 20), b = random_clip(8, 90, 20);
  InterpolateConfig config = config_of("own_pca");
  config.coefficients = 4;
  config.weight = 1;
  config.steps = 1;
  config.rate = 1e-6;
  const InterpolateResult result = interpolate(a, b, config);
  EXPECT_EQ(result.features, 4 * 72);
  const double n = static_cast<double>(result.features);
  const Eigen::MatrixXd step = unwound(result.result).poses - result.original.poses;
  const double fell = n * (result.error_before - result.error_after);
  EXPECT_GT(fell, 0);
  EXPECT_NEAR(fell, 2 * step.squaredNorm() / config.rate, 1e-2 * fell);
}

// Joints that never move have components without strength: no reason to fail.
TEST(Interpolate, OwnComponentsTakeConstantChannels) {
  Clip a = random_clip(9, 40, 20), b = random_clip(10, 40, 20);
  for (Clip* clip : {&a, &b}) clip->poses.rightCols(36).setZero();
  const InterpolateResult result = interpolate(a, b, config_of("own_pca"));
  EXPECT_LT(result.error_after, result.error_before);
  check_clip(result.result, "constant channels");
}

TEST(Interpolate, ShortMotionsHaveNoStft) {
  const Clip a = random_clip(1, 6, 20), b = random_clip(2, 6, 20);
  InterpolateConfig config = config_of("dct");
  const Table table = interpolate_table(interpolate(a, b, config), config);
  EXPECT_TRUE(table.rows()[2][3].is_null());
  EXPECT_TRUE(table.rows()[2][5].is_number());
}

TEST(Interpolate, BadInputIsAnswered) {
  const Clip a = random_clip(1, 40, 20);
  const auto usage = [&](const auto& change) {
    InterpolateConfig config = config_of("dct");
    change(config);
    return refusal<UsageError>([&] { interpolate(a, a, config); });
  };
  EXPECT_TRUE(contains(usage([](auto& c) { c.from_hz = 3, c.to_hz = 2; }), "from_hz"));
  EXPECT_TRUE(contains(usage([](auto& c) { c.target = "pca", c.coefficients = 41; }), "41"));
  EXPECT_TRUE(contains(usage([](auto& c) { c.target = "own_pca", c.coefficients = 41; }), "41"));
  EXPECT_TRUE(contains(refusal([&] { interpolate(a, random_clip(2, 1, 20), config_of("dct")); }),
                       "one frame"));
  EXPECT_TRUE(contains(refusal([&] { interpolate(a, random_clip(2, 7, 20), config_of("stft")); }),
                       "Hann window"));
  // A motion towards itself stays.
  EXPECT_LT(angle_apart(a, interpolate(a, a, config_of("stft")).result).most, 1e-3);
}

}  // namespace
}  // namespace mocaplm::interpolate_test
