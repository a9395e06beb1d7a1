#include "motion/skeleton.h"

#include <gtest/gtest.h>

#include <set>

#include "common/error.h"
#include "motion/helpers.h"

namespace mocaplm::skeleton_test {
namespace {

// Rodrigues' formula, written out with no help from motion/rotation.h.
Eigen::Matrix4d joint_matrix(const Eigen::Vector3d& v, const Eigen::Vector3d& offset) {
  const double angle = v.norm();
  Eigen::Matrix3d k = Eigen::Matrix3d::Zero();
  if (angle > 0) {
    const Eigen::Vector3d a = v / angle;
    k << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  }
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() += std::sin(angle) * k + (1 - std::cos(angle)) * k * k;
  m.topRightCorner<3, 1>() = offset;
  return m;
}

// Slow forward kinematics: every joint multiplies homogeneous matrices from the root on.
Eigen::Matrix4d world_matrix(const Clip& clip, Eigen::Index frame, int joint) {
  const int parent = joint_parents()[static_cast<std::size_t>(joint)];
  const Eigen::Vector3d v = clip.poses.row(frame).segment<3>(3 * joint).transpose();
  const Eigen::Vector3d rest = rest_joints().row(joint).transpose();
  if (parent < 0) return joint_matrix(v, rest + clip.trans.row(frame).transpose());
  return world_matrix(clip, frame, parent) *
         joint_matrix(v, rest - rest_joints().row(parent).transpose());
}

TEST(Skeleton, ForwardKinematicsMatchesHomogeneousMatrices) {
  Random random(31);
  const Clip clip = random_clip(random, 20, 60, 6);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions positions = joint_positions(clip, t);
    const auto rotations = joint_world_rotations(clip, t);
    for (int j = 0; j < kJoints; ++j) {
      const Eigen::Matrix4d expected = world_matrix(clip, t, j);
      ASSERT_LT((positions.row(j).transpose() - expected.topRightCorner<3, 1>()).norm(), 1e-12)
          << j;
      ASSERT_LT((rotations[static_cast<std::size_t>(j)] - expected.topLeftCorner<3, 3>()).norm(),
                1e-12);
    }
  }
}

TEST(Skeleton, RestPoseIsATPoseFacingZWithItsLeftAtX) {
  Clip clip;
  clip.fps = 1;
  clip.poses = Poses::Zero(1, 72);
  clip.trans = Translations::Zero(1, 3);
  const JointPositions rest = joint_positions(clip, 0);
  EXPECT_LT((rest - rest_joints()).norm(), 1e-12);
  const auto at = [&](const char* name, int axis) { return rest(joint_index(name), axis); };
  EXPECT_GT(at("left_hand", 0), 0.7);
  EXPECT_LT(at("right_hand", 0), -0.7);
  EXPECT_GT(at("head", 1), at("left_foot", 1) + 1.4);
  EXPECT_GT(at("left_foot", 2), at("left_ankle", 2) + 0.1);  // toes point forward
}

TEST(Skeleton, IsATreeWithMirroredSides) {
  for (int j = 0; j < kJoints; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const int parent = joint_parents()[at], other = mirrored_joints()[at];
    ASSERT_LT(parent, j);
    ASSERT_EQ(mirrored_joints()[static_cast<std::size_t>(other)], j);
    if (parent >= 0) {
      ASSERT_EQ(joint_parents()[static_cast<std::size_t>(other)],
                mirrored_joints()[static_cast<std::size_t>(parent)]);
    }
    ASSERT_EQ(joint_index(joint_names()[at]), j);
    std::string name = joint_names()[at];
    if (name.rfind("left_", 0) == 0) name = "right_" + name.substr(5);
    ASSERT_TRUE(other == joint_index(name) || joint_names()[at].rfind("right_", 0) == 0);
    // The published rest pose is symmetric to about 2 cm.
    ASSERT_NEAR(rest_joints()(j, 0), -rest_joints()(other, 0), 0.02);
    ASSERT_NEAR(rest_joints()(j, 1), rest_joints()(other, 1), 0.02);
  }
  EXPECT_EQ(joint_index("tail"), -1);
  EXPECT_EQ(thesis_joints().size(), 13u);
}

TEST(Skeleton, ParsesJointsAndGroups) {
  EXPECT_EQ(parse_joints({"thesis"}), thesis_joints());
  EXPECT_EQ(parse_joints({"right_arm", "pelvis", "right_elbow"}),
            (std::vector<int>{0, 17, 19, 21}));
  EXPECT_EQ(parse_joints({"all"}).size(), 24u);
  EXPECT_TRUE(parse_joints({}).empty());
  try {
    parse_joints({"right_amr"});
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("right_arm"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace mocaplm::skeleton_test
