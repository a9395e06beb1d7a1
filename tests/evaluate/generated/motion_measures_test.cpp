#include "evaluate/generated/motion_measures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "motion/skeleton.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::motion_measures_test {
namespace {

Clip standing(Eigen::Index frames, double fps = 20) {
  Clip clip;
  clip.fps = fps;
  clip.poses = Poses::Zero(frames, 72);
  clip.trans = Translations::Zero(frames, 3);
  return clip;
}

const std::vector<int> kHands = {22, 23};

}  // namespace

TEST(MotionMeasures, NothingMovesInAStandingBody) {
  const Clip clip = standing(50);
  const MotionMeasures m = measure_motion(clip, kHands, toe_level(clip));
  for (const Average& none : {m.root_speed, m.root_2s, m.root_end, m.root_farthest, m.joint_speed,
                              m.acceleration, m.jerk, m.contact_speed, m.skating})
    EXPECT_NEAR(none.value(), 0, 1e-9);  // a third difference of rounding errors
  EXPECT_EQ(m.contact.value(), 1);
  EXPECT_EQ(m.lowest, m.highest);
  EXPECT_NEAR(m.height.value(), rest_joints()(0, 1), 1e-12);
  EXPECT_TRUE(std::isnan(m.frozen.value()));
}

// 1 m/s to the side, forward, and back over the floor.
TEST(MotionMeasures, ABodyThatSlides) {
  Clip clip = standing(101);
  for (Eigen::Index t = 0; t < 101; ++t) {
    const double way = t <= 50 ? static_cast<double>(t) : 100.0 - static_cast<double>(t);
    clip.trans.row(t) = 0.05 * way * Eigen::RowVector3d(0.6, 0, 0.8);
  }
  const MotionMeasures m = measure_motion(clip, kHands, toe_level(clip));
  EXPECT_NEAR(m.root_speed.value(), 1, 1e-9);
  EXPECT_NEAR(m.root_end.value(), 0, 1e-9);
  EXPECT_NEAR(m.root_farthest.value(), 2.5, 1e-9);
  EXPECT_NEAR(m.joint_speed.value(), 0, 1e-9);  // relative to the pelvis
  EXPECT_NEAR(m.contact_speed.value(), 1, 1e-9);
  EXPECT_EQ(m.skating.value(), 1);
  // 1 m/s turns round within a frame, once in 99 second differences.
  EXPECT_NEAR(m.acceleration.value(), 2 * 20.0 / 99, 1e-9);
  // The way from 2 s before is 2 m, less around the turn.
  double expected = 0;
  for (int t = 40; t <= 100; ++t) {
    const auto at = [](int s) { return 0.05 * (s <= 50 ? s : 100 - s); };
    expected += std::abs(at(t) - at(t - 40)) / 61;
  }
  EXPECT_NEAR(m.root_2s.value(), expected, 1e-9);
}

TEST(MotionMeasures, FeetInTheAirDoNotSkate) {
  Clip clip = standing(40);
  const double floor = toe_level(clip);
  for (Eigen::Index t = 0; t < 40; ++t) clip.trans.row(t) << 0.05 * static_cast<double>(t), 0.2, 0;
  const MotionMeasures m = measure_motion(clip, kHands, floor);
  EXPECT_EQ(m.contact.value(), 0);
  EXPECT_EQ(m.skating.value(), 0);
  EXPECT_TRUE(std::isnan(m.contact_speed.value()));
  EXPECT_NEAR(toe_level(clip), floor + 0.2, 1e-12);
}

// A whole arm that turns at a constant rate: the hand is on a circle.
TEST(MotionMeasures, AHandOnACircle) {
  const double fps = 200, rate = 2 * kPi;  // a turn a second
  Clip clip = standing(400, fps);
  for (Eigen::Index t = 0; t < 400; ++t)
    clip.poses(t, 3 * joint_index("left_shoulder") + 1) = rate * static_cast<double>(t) / fps;
  const Eigen::RowVector3d arm = rest_joints().row(22) - rest_joints().row(16);
  const double radius = std::hypot(arm.x(), arm.z());
  const MotionMeasures m = measure_motion(clip, {22}, toe_level(clip));
  EXPECT_NEAR(m.joint_speed.value() / (radius * rate), 1, 1e-3);
  EXPECT_NEAR(m.acceleration.value() / (radius * rate * rate), 1, 1e-3);
  EXPECT_NEAR(m.jerk.value() / (radius * rate * rate * rate), 1, 1e-3);
}

TEST(MotionMeasures, AddUp) {
  const Clip a = random_clip(1, 30), b = random_clip(2, 50);
  const MotionMeasures one = measure_motion(a, kHands, 0), two = measure_motion(b, kHands, 0);
  MotionMeasures both = one;
  both.add(two);
  EXPECT_NEAR(both.root_speed.value(),
              (29 * one.root_speed.value() + 49 * two.root_speed.value()) / 78, 1e-12);
  EXPECT_NEAR(both.root_end.value(), (one.root_end.value() + two.root_end.value()) / 2, 1e-12);
  EXPECT_EQ(both.lowest, std::min(one.lowest, two.lowest));
  EXPECT_EQ(both.highest, std::max(one.highest, two.highest));
  EXPECT_EQ(both.jerk.count, 2 * (27 + 47));
}

TEST(MotionMeasures, ShortClipsAreMeasuredAsFarAsTheyGo) {
  for (Eigen::Index frames : {0, 1, 2, 3}) {
    const Clip clip = random_clip(3, 3);
    const MotionMeasures m = measure_motion(slice(clip, 0, frames), kHands, 0);
    EXPECT_EQ(m.height.count, frames);
    EXPECT_EQ(m.jerk.count, 0);
  }
}

}  // namespace mocaplm::motion_measures_test
