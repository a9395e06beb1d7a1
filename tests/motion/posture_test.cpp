#include "motion/posture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "motion/floor.h"
#include "motion/helpers.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/synth.h"

namespace mocaplm::posture_test {
namespace {

Eigen::Vector3d rest(int joint) {
  return rest_joints().row(joint).transpose();
}

// Stands in the rest pose, the soles at 0.
Clip standing(Eigen::Index frames = 20, double fps = 30) {
  Clip clip;
  clip.name = "standing";
  clip.fps = fps;
  clip.poses.setZero(frames, 72);
  clip.trans.setZero(frames, 3);
  stand_on_ground(clip);
  return clip;
}

void turn(Clip& clip, int joint, const Eigen::Vector3d& axis_angle) {
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    clip.poses.row(t).segment<3>(3 * joint) = axis_angle.transpose();
}

std::vector<std::string> kinds(const Clip& clip, const RetargetReport& report = {}) {
  std::vector<std::string> all;
  for (const Remark& remark : unlikely(measure_posture(clip), report)) all.push_back(remark.kind);
  return all;
}
using Kinds = std::vector<std::string>;

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(a.normalized().dot(b.normalized())) * 180 / kPi;
}

TEST(Posture, OfTheRestPose) {
  const BodyPosture posture = measure_posture(standing());
  const Eigen::Vector3d trunk = 0.5 * (rest(16) + rest(17) - rest(1) - rest(2));
  EXPECT_LT((posture.trunk - trunk).norm(), 1e-12);
  EXPECT_LT((posture.hip_line - (rest(1) - rest(2))).norm(), 1e-12);
  EXPECT_LT((posture.shoulder_line - (rest(16) - rest(17))).norm(), 1e-12);
  EXPECT_LT((posture.head - (rest(15) - rest(0))).norm(), 1e-12);
  EXPECT_NEAR(posture.lean, degrees_between(trunk, Eigen::Vector3d::UnitY()), 1e-9);
  EXPECT_LT(posture.twist, 2);
  EXPECT_LT(posture.head_turn, 2);
  EXPECT_LT(posture.feet_turn[0] + posture.feet_turn[1], 30);
  EXPECT_NEAR(posture.height, 1.73, 0.02);  // of the mean body
  EXPECT_NEAR(posture.lowest_foot, kSoleBelowFoot, 0.003);
  EXPECT_NEAR(posture.usual_foot, kSoleBelowFoot, 0.003);
  EXPECT_NEAR(posture.slide.value(), 0, 1e-9);
  EXPECT_EQ(posture.travel, 0);
  EXPECT_EQ(kinds(standing()), Kinds{});
}

// Where the figure stands and faces is no matter; what turns with it turns with it.
TEST(Posture, IsTheSameWhereverItFaces) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    Clip clip = random_clip(random, 12, 30, 0.7), turned = clip;
    const Eigen::Vector3d up(0, random.uniform(-3, 3), 0);
    const Eigen::Quaterniond turn = quaternion_from_axis_angle(up);
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const Eigen::Vector3d root = clip.poses.row(t).head<3>().transpose();
      turned.poses.row(t).head<3>() =
          axis_angle_from_quaternion(turn * quaternion_from_axis_angle(root)).transpose();
      const Eigen::Vector3d pelvis = clip.trans.row(t).transpose() + rest(0);
      turned.trans.row(t) = (turn * pelvis - rest(0)).transpose();
    }
    const BodyPosture a = measure_posture(clip), b = measure_posture(turned);
    EXPECT_LT((turn * a.trunk - b.trunk).norm(), 1e-9);
    EXPECT_LT((turn * a.feet[1] - b.feet[1]).norm(), 1e-9);
    EXPECT_NEAR(a.lean, b.lean, 1e-6);
    EXPECT_NEAR(a.twist, b.twist, 1e-6);
    EXPECT_NEAR(a.head_turn, b.head_turn, 1e-6);
    EXPECT_NEAR(a.feet_turn[0], b.feet_turn[0], 1e-6);
    EXPECT_NEAR(a.height, b.height, 1e-9);
    EXPECT_NEAR(a.travel, b.travel, 1e-6);
    EXPECT_EQ(a.knees_backwards, b.knees_backwards);
  }
}

TEST(Posture, LeanAndTwistAreTheAnglesOfTheJoints) {
  for (const double degrees : {10., 40., 75.}) {
    Clip clip = standing();
    turn(clip, 0, {degrees * kPi / 180, 0, 0});  // forward
    const double upright = measure_posture(standing()).lean;
    EXPECT_NEAR(measure_posture(clip).lean, degrees, upright + 1e-9);
    clip = standing();
    turn(clip, 3, {0, degrees * kPi / 180, 0});
    EXPECT_NEAR(measure_posture(clip).twist, degrees, 3);
    clip = standing();
    turn(clip, 15, {0, -degrees * kPi / 180, 0});
    EXPECT_NEAR(measure_posture(clip).head_turn, degrees, 3);
    clip = standing();
    turn(clip, 8, {0, -degrees * kPi / 180, 0});
    EXPECT_NEAR(measure_posture(clip).feet_turn[1] - measure_posture(standing()).feet_turn[1],
                degrees, 3);
  }
}

// Walks on the spot of its own feet: hips and knees move at random, the ankles keep the feet level
// and pointing ahead, and the root is put where one foot, the left and the right in turn, stands
// still. The other is lifted.
Clip stepping(std::uint64_t seed, double fps) {
  Random random(seed);
  Clip clip = standing(static_cast<Eigen::Index>(4 * fps), fps);
  Eigen::RowVector3d planted = joint_positions(clip, 0).row(10);
  int stands = 10;
  const double pace = random.uniform(0.7, 1.3), swing = random.uniform(0.1, 0.2);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const double phase = 2 * kPi * pace * static_cast<double>(t) / fps;
    for (int side = 0; side < 2; ++side) {
      const double s = side == 0 ? 1 : -1,
                   lift = std::sqrt(std::max(0.0, s * std::sin(phase + kPi)));
      const Eigen::Vector3d hip(-s * swing * std::cos(phase) - 0.9 * lift, 0,
                                0.05 * std::sin(phase)),
          knee(1.5 * lift + 0.1, 0, 0);
      clip.poses.row(t).segment<3>(3 * (1 + side)) = hip.transpose();
      clip.poses.row(t).segment<3>(3 * (4 + side)) = knee.transpose();
      const Eigen::Matrix3d leg = matrix_from_axis_angle(hip) * matrix_from_axis_angle(knee);
      clip.poses.row(t).segment<3>(3 * (7 + side)) =
          axis_angle_from_matrix(leg.transpose()).transpose();
    }
    const int next = std::sin(phase) >= 0 ? 10 : 11;
    if (next != stands) planted = joint_positions(clip, t - 1).row(next);
    if (next != stands) planted.y() = kSoleBelowFoot;
    stands = next;
    clip.trans.row(t) += planted - joint_positions(clip, t).row(stands);
  }
  return clip;
}

TEST(Posture, PlantedFeetDoNotSlideAndWithASlidingRootTheyDo) {
  for (const double fps : {30., 60., 120., 24.})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Clip clip = stepping(seed, fps);
      SCOPED_TRACE(std::to_string(fps) + " " + std::to_string(seed));
      for (const Eigen::Index most : {0, 64}) {
        const BodyPosture posture = measure_posture(clip, most);
        ASSERT_TRUE(posture.slide.has_value());
        EXPECT_LT(*posture.slide, 0.5);
        EXPECT_GT(posture.travel, 10);  // it goes about
        for (const double speed : {10., 80.}) {
          Clip sliding = clip;
          for (Eigen::Index t = 0; t < clip.frames(); ++t)
            sliding.trans.row(t) += speed / 100 * static_cast<double>(t) / fps *
                                    Eigen::RowVector3d(std::sin(1.0), 0, std::cos(1.0));
          EXPECT_NEAR(measure_posture(sliding, most).slide.value(), speed, 3) << most;
          EXPECT_EQ(kinds(speed < 50 ? sliding : clip), Kinds{});
        }
      }
    }
}

TEST(Posture, JumpsAndLyingHaveNoPlantedFoot) {
  Clip clip = standing(30, 30);
  for (Eigen::Index t = 0; t < 30; ++t) clip.trans(t, 1) += t < 3 ? 0.0 : 0.2 + 0.05 * t;
  EXPECT_FALSE(measure_posture(clip).slide.has_value());
  EXPECT_FALSE(measure_posture(standing(1)).slide.has_value());
}

TEST(Posture, FewFramesShowWhatAllDo) {
  const Clip clip = stepping(3, 120);
  const BodyPosture all = measure_posture(clip), some = measure_posture(clip, 64);
  EXPECT_EQ(all.trunk, some.trunk);
  EXPECT_NEAR(all.lean, some.lean, 1);
  EXPECT_NEAR(all.height, some.height, 0.02);
  EXPECT_NEAR(all.travel, some.travel, 0.1 * all.travel);
}

TEST(Posture, WhatIsUnlikelyIsCalledOut) {
  const auto with = [](int joint, double x, double y, double z) {
    Clip clip = standing();
    turn(clip, joint, {x, y, z});
    if (joint == 0) stand_on_ground(clip);
    return clip;
  };
  EXPECT_EQ(kinds(with(0, kPi / 2, 0, 0)).at(0), "trunk lying");
  EXPECT_EQ(kinds(with(0, kPi, 0, 0)).at(0), "trunk upside down");
  EXPECT_EQ(kinds(with(15, 0, kPi, 0)), Kinds{"head backwards"});
  EXPECT_EQ(kinds(with(15, 0, 1, 0)), Kinds{});  // over the shoulder
  EXPECT_EQ(kinds(with(15, 0, 0, kPi)), Kinds{"head upside down"});
  EXPECT_EQ(kinds(with(3, 0, kPi / 2, 0)), (Kinds{"hips across the shoulders"}));
  EXPECT_EQ(kinds(with(3, 0, kPi / 4, 0)), Kinds{});
  EXPECT_EQ(kinds(with(7, 0, kPi, 0)), (Kinds{"feet backwards", "ankles turned over"}));
  EXPECT_EQ(kinds(with(8, 0, 0, kPi)), Kinds{"ankles turned over"});
  EXPECT_EQ(kinds(with(1, 0, kPi, 0)), Kinds{"feet backwards"});
  EXPECT_EQ(kinds(with(7, 0, 1.2, 0)), Kinds{});  // turned out
  EXPECT_EQ(kinds(with(4, -1, 0, 0)), Kinds{"knees backwards"});
  EXPECT_EQ(kinds(with(4, 1, 0, 0)), Kinds{});
  Clip clip = standing();
  turn(clip, 13, {0, 0, 1.3});  // collars up
  turn(clip, 14, {0, 0, -1.3});
  EXPECT_EQ(kinds(clip), Kinds{"shoulders folded in"});
  clip = standing();
  clip.trans.col(1).array() -= 0.08;
  EXPECT_EQ(kinds(clip), Kinds{"feet under the floor"});
  clip.trans.col(1).array() += 0.06;
  EXPECT_EQ(kinds(clip), Kinds{});
  clip.trans.col(1).array() += 0.9;
  EXPECT_EQ(kinds(clip), Kinds{"feet over the floor"});
  RetargetReport report;
  report.unit = 0.01;
  for (const auto& [height, expected] : {std::pair<double, Kinds>{0.4, {"small figure"}},
                                         {4, {"large figure"}},
                                         {1.45, {}},
                                         {0.9, {}}}) {
    report.height = height;
    EXPECT_EQ(kinds(standing(), report), expected) << height;
  }
}

TEST(Posture, ProceduralDancesAreSound) {
  SynthConfig config;
  config.seconds = 8;
  for (const auto& plan : plan_dances(config)) EXPECT_EQ(kinds(make_dance(plan, config)), Kinds{});
}

}  // namespace
}  // namespace mocaplm::posture_test
