#include "evaluate/generated/forecast_windows.h"

#include <gtest/gtest.h>

#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::forecast_windows_test {
namespace {

// Joint 5 turns by 0.1 a frame about a fixed axis of its own frame, the root moves on a line.
Clip steady_clip(Eigen::Index frames) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3, start(0.3, -0.8, 0.2);
  Clip clip;
  clip.fps = 60;
  clip.poses = Poses::Zero(frames, 72);
  clip.trans = Translations::Zero(frames, 3);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const auto turned = quaternion_from_axis_angle(start) *
                        quaternion_from_axis_angle(0.1 * static_cast<double>(t) * axis);
    clip.poses.row(t).segment<3>(15) = axis_angle_from_quaternion(turned).transpose();
    clip.trans(t, 2) = 0.02 * static_cast<double>(t);
  }
  return clip;
}

}  // namespace

// The protocol cuts a clip into windows of 180 frames, each 120 after the one before.
TEST(ForecastWindows, AreCutAsInTheProtocol) {
  for (const auto& [frames, count] : {std::pair{179, 0u}, {180, 1u}, {299, 1u}, {300, 2u}}) {
    const Clip clip = random_clip(1, frames, 60);
    const auto windows = forecast_windows(clip, 120, 24);
    ASSERT_EQ(windows.size(), count) << frames;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const auto first = static_cast<Eigen::Index>(120 * i);
      EXPECT_EQ(windows[i].seed.poses, clip.poses.middleRows(first, 120));
      EXPECT_EQ(windows[i].target.poses, clip.poses.middleRows(first + 120, 24));
    }
  }
  EXPECT_EQ(forecast_windows(random_clip(1, 199, 60), 120, 80).size(), 0u);
  EXPECT_EQ(forecast_windows(random_clip(1, 200, 60), 120, 80).size(), 1u);
}

TEST(ForecastWindows, ZeroVelocityStaysWhereItIs) {
  const Clip seed = random_clip(2, 7);
  const Clip still = zero_velocity(seed, 5);
  ASSERT_EQ(still.frames(), 5);
  for (Eigen::Index t = 0; t < 5; ++t) {
    EXPECT_EQ(still.poses.row(t), seed.poses.row(6));
    EXPECT_EQ(still.trans.row(t), seed.trans.row(6));
  }
}

TEST(ForecastWindows, LinearExtrapolationGoesOnTurning) {
  const Clip whole = steady_clip(40);
  const Clip forecast = linear_extrapolation(slice(whole, 0, 10), 30);
  for (Eigen::Index t = 0; t < 30; ++t) {
    const auto rotation = [&](const Clip& clip, Eigen::Index frame) {
      return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(15).transpose());
    };
    EXPECT_LT(geodesic_angle(rotation(forecast, t), rotation(whole, t + 10)), 1e-12) << t;
    EXPECT_NEAR(forecast.trans(t, 2), whole.trans(t + 10, 2), 1e-12);
  }
  const Clip one = slice(whole, 3, 1);
  EXPECT_EQ(linear_extrapolation(one, 4).poses, zero_velocity(one, 4).poses);
}

TEST(ForecastWindows, LinearExtrapolationTakesTheShorterWay) {
  Clip seed = steady_clip(2);
  seed.poses.setZero();
  // 0.2 short of half a turn, then 0.2 beyond, told as the vector from the other side.
  const double pi = 3.14159265358979323846;
  seed.poses(0, 15) = pi - 0.2;
  seed.poses(1, 15) = -pi + 0.2;
  const Clip forecast = linear_extrapolation(seed, 1);
  EXPECT_NEAR(forecast.poses(0, 15), -pi + 0.6, 1e-12);
}

}  // namespace mocaplm::forecast_windows_test
