// Turning a motion turns every joint's position, and nothing else changes.
#include "motion/turn.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/helpers.h"
#include "motion/skeleton.h"

namespace mocaplm::turn_test {
namespace {

TEST(Turn, TurnsEveryPositionAboutTheVertical) {
  Random random(5);
  const Clip clip = random_clip(random, 20, 60);
  for (const double angle : {0.3, -2.0, 3.1, 6.0}) {
    const Clip other = turned(clip, angle);
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const JointPositions before = joint_positions(clip, t), after = joint_positions(other, t);
      for (int j = 0; j < kJoints; ++j) {
        EXPECT_NEAR(after(j, 0), std::cos(angle) * before(j, 0) + std::sin(angle) * before(j, 2),
                    1e-9);
        EXPECT_NEAR(after(j, 1), before(j, 1), 1e-9);
        EXPECT_NEAR(after(j, 2), std::cos(angle) * before(j, 2) - std::sin(angle) * before(j, 0),
                    1e-9);
      }
    }
    EXPECT_TRUE(other.poses.rightCols(69) == clip.poses.rightCols(69));
  }
}

TEST(Turn, TurningBackGivesTheMotion) {
  Random random(6);
  const Clip clip = random_clip(random, 20, 60);
  const Clip again = turned(turned(clip, 1.1), -1.1);
  EXPECT_LT((again.trans - clip.trans).cwiseAbs().maxCoeff(), 1e-12);
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    EXPECT_LT((joint_positions(again, t) - joint_positions(clip, t)).cwiseAbs().maxCoeff(), 1e-9);
}

// Each joint of the turned motion is the turned joint of the motion, the pelvis too, also for a
// body of its own.
TEST(Turn, TurningTheWorldTurnsEveryJoint) {
  Random random(7);
  for (int body = 0; body < 2; ++body) {
    Clip clip = random_clip(random, 9, 60);
    if (body == 1) {
      auto shape = std::make_shared<BodyShape>();
      shape->rest = rest_joints() * 1.1;
      clip.body = shape;
    }
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(2.3, random_direction(random)).toRotationMatrix();
    Clip other = clip;
    turn_world(other, turn);
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const JointPositions before = joint_positions(clip, t), after = joint_positions(other, t);
      EXPECT_LT((after - before * turn.transpose()).cwiseAbs().maxCoeff(), 1e-9);
    }
    EXPECT_EQ(other.body, clip.body);
  }
}

}  // namespace
}  // namespace mocaplm::turn_test
