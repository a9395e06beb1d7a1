#include "motion/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "motion/helpers.h"
#include "motion/rotation.h"

namespace mocaplm::resample_test {
namespace {

double rotation_error(const Clip& a, Eigen::Index s, const Clip& b, Eigen::Index t) {
  double worst = 0;
  for (int j = 0; j < 24; ++j)
    worst = std::max(
        worst,
        geodesic_angle(quaternion_from_axis_angle(a.poses.row(s).segment<3>(3 * j).transpose()),
                       quaternion_from_axis_angle(b.poses.row(t).segment<3>(3 * j).transpose())));
  return worst;
}

// Every joint turns about its own fixed axis at its own constant speed: slerp is exact then.
Clip steady_clip(Eigen::Index frames, double fps) {
  Random random(7);
  Clip clip;
  clip.fps = fps;
  clip.poses.resize(frames, 72);
  clip.trans.resize(frames, 3);
  for (int j = 0; j < 24; ++j) {
    const Eigen::Vector3d axis = random_direction(random);
    const double speed = random.uniform(0.5, 9);
    for (Eigen::Index t = 0; t < frames; ++t)
      clip.poses.row(t).segment<3>(3 * j) =
          std::remainder(speed * static_cast<double>(t) / fps, 2 * kPi) * axis.transpose();
  }
  for (Eigen::Index t = 0; t < frames; ++t)
    clip.trans.row(t) << 1 + static_cast<double>(t) / fps, 2, -3 * static_cast<double>(t) / fps;
  return clip;
}

TEST(Resample, FollowsASteadyTurnAtAnyRate) {
  const Clip source = steady_clip(121, 60);
  for (double fps : {7.0, 20.0, 24.0, 25.0, 29.97, 50.0, 59.0, 61.0, 100.0, 120.0, 333.3}) {
    const Clip out = resample(source, fps);
    EXPECT_EQ(out.fps, fps);
    EXPECT_EQ(out.frames(), static_cast<Eigen::Index>(std::floor(2 * fps + 1e-7)) + 1) << fps;
    const Clip expected = steady_clip(out.frames(), fps);
    for (Eigen::Index t = 0; t < out.frames(); ++t) {
      ASSERT_LT(rotation_error(out, t, expected, t), 1e-9) << fps << " frame " << t;
      ASSERT_LT((out.trans.row(t) - expected.trans.row(t)).norm(), 1e-12);
    }
  }
}

// Slerp as a share of the turn between the frames, for frames near to and far from each other.
TEST(Resample, IsSlerpToRoundingAtEveryDistance) {
  Random random(17);
  for (int trial = 0; trial < 2000; ++trial) {
    const double angle = std::pow(10, random.uniform(-9, std::log10(3.0)));
    const Eigen::Vector3d start = random.uniform(0, 3) * random_direction(random);
    const Eigen::Quaterniond a = quaternion_from_axis_angle(start),
                             turn = quaternion_from_axis_angle(angle * random_direction(random));
    Clip clip;
    clip.fps = 10;
    clip.poses.setZero(2, 72);
    clip.trans.setZero(2, 3);
    clip.poses.row(0).head<3>() = start.transpose();
    clip.poses.row(1).head<3>() = axis_angle_from_quaternion(a * turn).transpose();
    const Clip out = resample(clip, 10 * 3);  // at 0, 1/3, 2/3, 1
    for (int i = 1; i < 3; ++i) {
      const Eigen::Quaterniond expected =
          a * quaternion_from_axis_angle(axis_angle_from_quaternion(turn) * i / 3.0);
      const Eigen::Quaterniond found =
          quaternion_from_axis_angle(out.poses.row(i).head<3>().transpose());
      ASSERT_LT(geodesic_angle(expected, found), 3e-15) << angle;
    }
  }
}

TEST(Resample, OfSomeJointsLeavesTheOthersOut) {
  const Clip source = steady_clip(121, 60);
  const std::vector<int> joints = {0, 4, 21};
  const Clip all = resample(source, 50), some = resample(source, 50, joints);
  EXPECT_EQ(some.trans, all.trans);
  for (int j = 0; j < 24; ++j) {
    const bool wanted = std::count(joints.begin(), joints.end(), j) > 0;
    const auto part = some.poses.middleCols<3>(3 * j);
    EXPECT_TRUE(wanted ? part == all.poses.middleCols<3>(3 * j) : part.isZero(0)) << j;
  }
}

TEST(Resample, TakesFramesBitForBitAtADivisor) {
  Random random(1);
  const Clip source = random_clip(random, 97, 120);
  EXPECT_TRUE(resample(source, 120).poses == source.poses);
  for (int step : {2, 3, 4, 6, 120}) {
    const Clip out = resample(source, 120.0 / step);
    ASSERT_EQ(out.frames(), (97 - 1) / step + 1);
    for (Eigen::Index t = 0; t < out.frames(); ++t) {
      ASSERT_TRUE(out.poses.row(t) == source.poses.row(t * step));
      ASSERT_TRUE(out.trans.row(t) == source.trans.row(t * step));
    }
  }
}

TEST(Resample, LiesOnTheShorterArcBetweenTheNeighbours) {
  Random random(2);
  const Clip source = random_clip(random, 30, 30, kPi);
  const Clip out = resample(source, 100);
  for (Eigen::Index t = 0; t < out.frames(); ++t) {
    const double at = static_cast<double>(t) * 0.3;
    const auto first = std::min<Eigen::Index>(static_cast<Eigen::Index>(at + 1e-9), 28);
    for (int j = 0; j < 24; ++j) {
      const auto q = [&](const Clip& clip, Eigen::Index frame) {
        return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * j).transpose());
      };
      const double whole = geodesic_angle(q(source, first), q(source, first + 1));
      const double part = geodesic_angle(q(source, first), q(out, t));
      ASSERT_NEAR(part, whole * (at - static_cast<double>(first)), 1e-9);
      ASSERT_NEAR(part + geodesic_angle(q(out, t), q(source, first + 1)), whole, 1e-9);
    }
  }
}

TEST(Resample, GivesRotationVectorsThatDoNotJump) {
  const Clip out = resample(steady_clip(600, 60), 77);
  for (Eigen::Index t = 1; t < out.frames(); ++t)
    for (int j = 0; j < 24; ++j) {
      const double step = (out.poses.row(t) - out.poses.row(t - 1)).segment<3>(3 * j).norm();
      // A jump is left only where a component would leave [-pi, pi].
      if (step > 1) {
        ASSERT_GT(out.poses.row(t - 1).segment<3>(3 * j).cwiseAbs().maxCoeff(), kPi - 0.2);
      }
    }
  EXPECT_LE(out.poses.cwiseAbs().maxCoeff(), kPi);
}

TEST(Resample, StaysInsideShortAndLongClips) {
  Random random(3);
  for (Eigen::Index frames : {1, 2, 3, 50}) {
    const Clip source = random_clip(random, frames, 59.94);
    for (double fps : {0.01, 0.59, 13.7, 59.93, 59.9400001, 60.0, 1000.0}) {
      const Clip out = resample(source, fps);
      ASSERT_GE(out.frames(), 1);
      EXPECT_TRUE(out.poses.row(0) == source.poses.row(0));
      EXPECT_LE(static_cast<double>(out.frames() - 1) / fps,
                static_cast<double>(frames - 1) / 59.94 + 1e-6);
      EXPECT_GT(static_cast<double>(out.frames()) / fps,
                static_cast<double>(frames - 1) / 59.94 - 1e-6);
      EXPECT_TRUE(out.poses.allFinite());
    }
  }
}

TEST(Resample, RefusesRatesThatMakeNoSense) {
  Random random(4);
  const Clip source = random_clip(random, 400, 1);
  for (double fps : {0.0, -20.0, 1e5, std::nan("")})
    EXPECT_THROW(resample(source, fps), UsageError);
  EXPECT_THROW(resample(source, 10000), UsageError);  // four million frames
}

TEST(KeepContinuous, UndoesTheFlipAtPi) {
  Clip clip;
  clip.fps = 10;
  clip.poses = Poses::Zero(20, 72);
  clip.trans = Translations::Zero(20, 3);
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 2) / 3;
  for (int t = 0; t < 20; ++t)  // passes pi at frame 11
    clip.poses.row(t).segment<3>(9) = std::remainder(2.6 + 0.05 * t, 2 * kPi) * axis.transpose();
  const Clip before = clip;
  keep_continuous(clip, kPi);
  for (int t = 0; t < 20; ++t) {
    EXPECT_LT((clip.poses.row(t).segment<3>(9).transpose() - (2.6 + 0.05 * t) * axis).norm(), 1e-9);
    EXPECT_LT(rotation_error(clip, t, before, t), 1e-9);
  }
}

TEST(KeepContinuous, LeavesWhatFollowsAlone) {
  Random random(5);
  Clip clip = random_clip(random, 40, 30, 1.5);
  const Clip before = clip;
  keep_continuous(clip, kPi);
  EXPECT_TRUE(clip.poses == before.poses);
}

}  // namespace
}  // namespace mocaplm::resample_test
