// The recordings of ../shared/cases: kinds of .bvh files that people have, and what is right.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "common/angles.h"
#include "common/error.h"
#include "motion/formats/formats.h"
#include "motion/skeleton.h"

namespace mocaplm::bvh_cases_test {
namespace {

using Eigen::Vector3d;

class BvhCases : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::string(MOCAPLM_SOURCE_DIR) + "/../shared/cases";
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "no " << folder_;
  }
  Clip read(const std::string& name, const ReadOptions& options = {}) {
    return read_clip(folder_ + "/" + name, options, &report_);
  }
  static Vector3d at(const Clip& clip, Eigen::Index frame, int joint) {
    return joint_positions(clip, frame).row(joint).transpose();
  }
  static Vector3d direction(const Clip& clip, Eigen::Index frame, int from, int to) {
    return (at(clip, frame, to) - at(clip, frame, from)).normalized();
  }
  static void expect_near(const Vector3d& got, const Vector3d& right, double most,
                          const std::string& what) {
    EXPECT_LT((got - right).norm(), most) << what << " is " << got.transpose();
  }
  // Frame 0 of the figure: a T-pose facing +Z, left +X, on the floor.
  static void expect_standing(const Clip& clip) {
    expect_near(at(clip, 0, 0), {0, 0.95, 0}, 0.02, "pelvis");
    expect_near(at(clip, 0, 1) - at(clip, 0, 2), {0.14, 0, 0}, 0.01, "hip line");
    expect_near(at(clip, 0, 16) - at(clip, 0, 17), {0.35, 0, 0}, 0.01, "shoulder line");
    expect_near(at(clip, 0, 15) - at(clip, 0, 0), {0.01, 0.58, 0.01}, 0.01, "head - pelvis");
    EXPECT_NEAR(std::min(at(clip, 0, 10).y(), at(clip, 0, 11).y()), 0.026, 0.01);
  }

  std::string folder_;
  ReadReport report_;
};

TEST_F(BvhCases, JointNames) {
  for (const char* name :
       {"biovision_spec", "biped_spaces", "center_root", "makehuman_daz", "mixamo_no_colon",
        "rigify", "smpl_fbx_prefix", "unity_humanoid", "unreal"}) {
    SCOPED_TRACE(name);
    const Clip clip = read(std::string("joint-names/") + name + ".bvh");
    expect_standing(clip);
    expect_near(direction(clip, 0, 16, 18), {1, 0, 0}, 1e-3, "left upper arm");
    expect_near(direction(clip, 1, 1, 4), {0, -0.5, 0.866}, 1e-3, "left thigh");
    expect_near(direction(clip, 1, 4, 7), {0, -0.94, -0.342}, 1e-3, "left shin");
  }
}

TEST_F(BvhCases, UnitFromTheBody) {
  for (const char* name : {"cmu_0.45in", "inches"}) {
    SCOPED_TRACE(name);
    const Clip clip = read(std::string("unit-from-body/") + name + ".bvh");
    expect_standing(clip);
    EXPECT_NEAR(at(clip, 1, 0).z() - at(clip, 0, 0).z(), 1, 0.01);
    EXPECT_EQ(report_.remarks.at(0).kind, "unit");
  }
}

TEST_F(BvhCases, RokokoIsNotLafan) {
  expect_standing(read("rokoko-as-lafan/suit.bvh"));
}

TEST_F(BvhCases, AZeroPoseWithRaisedArmsIsNoTPose) {
  const Clip clip = read("zero-pose-not-a-t-pose/arms_up.bvh");
  expect_standing(clip);
  expect_near(at(clip, 0, 16) - at(clip, 0, 13), {0.091, 0.030, -0.009}, 0.01, "collar bone");
}

TEST_F(BvhCases, TurnsInTheHipJoints) {
  for (const Eigen::Index t : {0, 1}) {
    const Clip clip = read("turn-in-hip-joints/hipjoints.bvh");
    expect_near(at(clip, t, 1) - at(clip, t, 2), {0.14, 0, 0}, 0.01, "hip line");
    expect_near(at(clip, t, 16) - at(clip, t, 17), {0.35, 0, 0}, 0.01, "shoulder line");
  }
}

TEST_F(BvhCases, RestPoseYUpMotionZUp) {
  ReadOptions z;
  z.up = UpAxis::z;
  for (const ReadOptions& options : {ReadOptions(), z}) {
    const Clip clip = read("rest-y-up-motion-z-up/zworld.bvh", options);
    expect_standing(clip);
    EXPECT_NEAR(at(clip, 1, 0).z(), 1, 0.01);  // forward is -y there
  }
}

TEST_F(BvhCases, GiantsWalkOnTheFloor) {
  const Clip clip = read("root-not-scaled/giant.bvh");
  expect_standing(clip);
  ReadOptions options;
  options.unit = 0.01;
  const Clip scaled = read("root-not-scaled/giant.bvh", options);
  expect_standing(scaled);
  EXPECT_NEAR(at(scaled, 1, 0).z() - at(scaled, 0, 0).z(), 2 * 0.777 / 1.56, 0.01);
  options.keep_path = true;
  const Clip kept = read("root-not-scaled/giant.bvh", options);
  EXPECT_NEAR(at(kept, 1, 0).z() - at(kept, 0, 0).z(), 2, 1e-6);
}

TEST_F(BvhCases, LimbsThatEndInEndSites) {
  for (const bool with_map : {false, true}) {
    ReadOptions options;
    if (with_map) options.bvh_map = folder_ + "/limb-ends-in-end-site/no_hands.map.json";
    const Clip clip = read("limb-ends-in-end-site/no_hands.bvh", options);
    expect_standing(clip);
    expect_near(direction(clip, 0, 18, 20), {1, 0, 0}, 1e-3, "left forearm");
    expect_near(direction(clip, 1, 18, 20), {0.174, -0.985, 0}, 1e-3, "left forearm");
  }
}

TEST_F(BvhCases, HandsOfAnAPoseAreStraight) {
  for (const bool with_map : {false, true}) {
    ReadOptions options;
    if (with_map) options.bvh_map = folder_ + "/t-pose-frame-is-an-a-pose/apose.map.json";
    const Clip clip = read("t-pose-frame-is-an-a-pose/apose.bvh", options);
    for (const Eigen::Index t : {0, 1})
      expect_near(direction(clip, t, 20, 22), direction(clip, t, 18, 20), 1e-3, "left hand");
  }
}

TEST_F(BvhCases, TheTrunkLeansWithItsOnlyJoint) {
  const Clip clip = read("trunk-direction/one_low_chest.bvh");
  const auto lean = [&](Eigen::Index t) {
    const Vector3d trunk =
        0.5 * (at(clip, t, 16) + at(clip, t, 17)) - 0.5 * (at(clip, t, 1) + at(clip, t, 2));
    return std::atan2(trunk.z(), trunk.y()) * 180 / kPi;
  };
  EXPECT_NEAR(lean(1) - lean(0), 45, 3);
}

}  // namespace
}  // namespace mocaplm::bvh_cases_test
