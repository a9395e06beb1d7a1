#include "motion/joint_path.h"

#include <gtest/gtest.h>

#include "motion/skeleton.h"
#include "motion/turn.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::joint_path_test {
namespace {

TEST(JointPath, InTheWorldIsForwardKinematics) {
  const Clip clip = random_clip(3, 6, 30, "clip");
  const Eigen::MatrixXd path = joint_path(clip, 21, false);
  ASSERT_EQ(path.rows(), 6);
  for (Eigen::Index t = 0; t < 6; ++t)
    EXPECT_LT((path.row(t) - joint_positions(clip, t).row(21)).norm(), 1e-12);
}

TEST(JointPath, InTheBodyForgetsPlaceAndHeading) {
  const Clip clip = random_clip(4, 5, 30, "clip");
  Clip other = turned(clip, 2.1);
  other.trans.rowwise() += Eigen::RowVector3d(3, 0, -2);
  const Eigen::MatrixXd path = joint_path(clip, 20, true);
  EXPECT_LT((path - joint_path(other, 20, true)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(joint_path(clip, 0, true).cwiseAbs().maxCoeff(), 1e-12) << "the pelvis is the origin";
}

TEST(JointPath, ARestingBodyIsAsItIs) {
  Clip clip;
  clip.fps = 30;
  clip.poses = Poses::Zero(2, 72);
  clip.trans = Translations::Zero(2, 3);
  clip.poses.col(1).setConstant(1.2);  // turned about y
  const Eigen::MatrixXd path = joint_path(clip, 21, true);
  const Eigen::RowVector3d rest = rest_joints().row(21) - rest_joints().row(0);
  EXPECT_LT((path.rowwise() - rest).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace mocaplm::joint_path_test
