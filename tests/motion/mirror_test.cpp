#include "motion/mirror.h"

#include <gtest/gtest.h>

#include "motion/helpers.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm::mirror_test {
namespace {

// Forward kinematics on a rest pose that is exactly symmetric about x = pelvis.
JointPositions symmetric_positions(const Clip& clip, Eigen::Index frame) {
  JointPositions rest(kJoints, 3);
  for (int j = 0; j < kJoints; ++j) {
    const Eigen::RowVector3d own = rest_joints().row(j) - rest_joints().row(0);
    const Eigen::RowVector3d other =
        rest_joints().row(mirrored_joints()[static_cast<std::size_t>(j)]) - rest_joints().row(0);
    rest.row(j) << (own.x() - other.x()) / 2, (own.y() + other.y()) / 2, (own.z() + other.z()) / 2;
  }
  const auto world = joint_world_rotations(clip, frame);
  JointPositions positions(kJoints, 3);
  positions.row(0) = clip.trans.row(frame) + rest_joints().row(0);
  for (int j = 1; j < kJoints; ++j) {
    const auto parent = static_cast<std::size_t>(joint_parents()[static_cast<std::size_t>(j)]);
    const Eigen::Vector3d bone = (rest.row(j) - rest.row(static_cast<int>(parent))).transpose();
    positions.row(j) = positions.row(static_cast<int>(parent)) + (world[parent] * bone).transpose();
  }
  return positions;
}

TEST(Mirror, TwiceIsTheIdentity) {
  Random random(11);
  const Clip clip = random_clip(random, 25, 60);
  const Clip again = mirror(mirror(clip));
  EXPECT_TRUE(again.poses == clip.poses);
  EXPECT_LT((again.trans - clip.trans).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Mirror, MirrorsThePositionsOfASymmetricSkeleton) {
  Random random(12);
  const Clip clip = random_clip(random, 25, 60);
  const Clip mirrored = mirror(clip);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions before = symmetric_positions(clip, t);
    const JointPositions after = symmetric_positions(mirrored, t);
    for (int j = 0; j < kJoints; ++j) {
      const Eigen::RowVector3d source = before.row(mirrored_joints()[static_cast<std::size_t>(j)]);
      const Eigen::RowVector3d expected(-source.x(), source.y(), source.z());
      ASSERT_LT((after.row(j) - expected).norm(), 1e-12) << "frame " << t << " joint " << j;
    }
  }
}

TEST(Mirror, MirrorsRealPositionsUpToTheSkeletonsAsymmetry) {
  Random random(13);
  const Clip clip = random_clip(random, 10, 60, 0.4);
  const Clip mirrored = mirror(clip);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions before = joint_positions(clip, t), after = joint_positions(mirrored, t);
    EXPECT_NEAR(after(0, 0), -before(0, 0), 1e-12);
    for (int j = 0; j < kJoints; ++j) {
      const auto other = mirrored_joints()[static_cast<std::size_t>(j)];
      ASSERT_NEAR(after(j, 0), -before(other, 0), 0.03);
      ASSERT_NEAR(after(j, 1), before(other, 1), 0.03);
      ASSERT_NEAR(after(j, 2), before(other, 2), 0.03);
    }
  }
}

TEST(Mirror, SwapsTheSidesThatLabelsName) {
  Random random(14);
  Clip clip = random_clip(random, 1, 60);
  clip.labels = {{"content", "raise-up-left-hand"}, {"style", "bright"}, {"side", "right"}};
  const Labels expected = {
      {"content", "raise-up-right-hand"}, {"style", "bright"}, {"side", "left"}};
  EXPECT_EQ(mirror(clip).labels, expected);
  EXPECT_EQ(mirror(mirror(clip)).labels, clip.labels);
}

}  // namespace
}  // namespace mocaplm::mirror_test
