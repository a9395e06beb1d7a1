#include "tokenizer/root_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "common/random.h"
#include "motion/helpers.h"
#include "motion/rotation.h"

namespace mocaplm::root_motion_test {
namespace {

TEST(Heading, OfAYawIsTheYawAndTiltsDoNotTurn) {
  for (double yaw = -3.1; yaw < 3.1; yaw += 0.37) {
    EXPECT_NEAR(heading({0, yaw, 0}), yaw, 1e-12);
    for (const double pitch : {-1.4, -0.7, 0.7, 1.4}) {
      const Eigen::Matrix3d turned =
          matrix_from_axis_angle({0, yaw, 0}) * matrix_from_axis_angle({pitch, 0, 0});
      EXPECT_NEAR(std::remainder(heading(axis_angle_from_matrix(turned)) - yaw, 2 * kPi), 0, 1e-9);
    }
  }
}

TEST(Heading, LyingOnTheBackOrBellyPointsWhereThePelvisPointedBefore) {
  for (const double pitch : {-kPi / 2, kPi / 2}) {
    const Eigen::Matrix3d turned =
        matrix_from_axis_angle({0, 0.5, 0}) * matrix_from_axis_angle({pitch, 0, 0});
    EXPECT_NEAR(heading(axis_angle_from_matrix(turned)), 0.5, 1e-9);
  }
}

TEST(Heading, IsFiniteForEveryRotation) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.uniform(-kPi, kPi), y = random.uniform(-kPi, kPi),
                 z = random.uniform(-kPi, kPi);
    EXPECT_TRUE(std::isfinite(heading({x, y, z})));
  }
}

TEST(Heading, HasADirectionOfUnitLength) {
  Random random(6);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d v = random.uniform(0, 1.2) * kPi * random_direction(random);
    const Eigen::Vector2d direction = heading_direction(v);
    EXPECT_NEAR(direction.norm(), 1, 1e-14);
    const double angle = heading(v);
    EXPECT_LT((direction - Eigen::Vector2d(std::sin(angle), std::cos(angle))).norm(), 1e-14);
  }
}

TEST(Steps, LeftIsPlusXAndForwardPlusZAtHeadingZero) {
  const Eigen::Vector2d ahead(0, 1), left(1, 0);
  EXPECT_TRUE(to_dancer({1, 0}, ahead).isApprox(Eigen::Vector2d(1, 0)));
  EXPECT_TRUE(to_dancer({0, 1}, ahead).isApprox(Eigen::Vector2d(0, 1)));
  // Facing +X, a step along +X is forward, and +Z lies to the right.
  EXPECT_NEAR((to_dancer({1, 0}, left) - Eigen::Vector2d(0, 1)).norm(), 0, 1e-15);
  EXPECT_NEAR((to_dancer({0, 1}, left) - Eigen::Vector2d(-1, 0)).norm(), 0, 1e-15);
  for (double yaw = -4; yaw < 4; yaw += 0.3) {
    const Eigen::Vector2d direction(std::sin(yaw), std::cos(yaw)), step(0.3, -0.7);
    EXPECT_NEAR((to_floor(to_dancer(step, direction), direction) - step).norm(), 0, 1e-15);
  }
}

TEST(StepRange, KeepsZeroAtABinsCentreAndIgnoresOneBadJump) {
  Random random(7);
  for (const int bins : {2, 3, 90, 359, 360, 4096}) {
    for (const bool symmetric : {false, true}) {
      std::vector<double> values;
      for (int i = 0; i < 5000; ++i) values.push_back(random.uniform(-0.02, 0.06));
      values.push_back(50);
      const ValueRange range = step_range(values, bins, symmetric);
      EXPECT_LT(range.low, 0);
      EXPECT_GT(range.high, 0);
      EXPECT_LT(range.high, bins < 4 ? 0.25 : 0.1);
      const double zero =
          -range.low / (range.high - range.low) * bins - 0.5;  // the bin whose centre is 0
      EXPECT_NEAR(zero, std::round(zero), 1e-9);
      if (bins > 3) {
        EXPECT_LE(range.low, -0.02);
        EXPECT_GE(range.high, 0.06);
      }
    }
  }
}

TEST(StepRange, OfNoMovementIsStillARange) {
  const ValueRange range = step_range({0, 0, 0}, 360, true);
  EXPECT_GT(range.high - range.low, 0.01);
  const ValueRange height = absolute_range({0.9});
  EXPECT_LT(height.low, 0.9);
  EXPECT_GT(height.high, 0.9);
}

}  // namespace
}  // namespace mocaplm::root_motion_test
