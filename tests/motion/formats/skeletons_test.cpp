// Clips on the skeletons of other programs: names and hierarchy as those programs have them, the
// rest pose that they ask for, and every joint where the clip has it.
#include "motion/formats/skeletons.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "motion/body_mesh.h"
#include "motion/floor.h"
#include "motion/formats/bvh.h"
#include "motion/formats/formats.h"
#include "motion/formats/glb.h"
#include "motion/formats/helpers.h"
#include "motion/formats/retarget.h"
#include "motion/formats/skeleton_trees.h"
#include "motion/helpers.h"
#include "motion/resample.h"
#include "support/glb_file.h"

namespace mocaplm::skeletons_test {
namespace {

class Skeletons : public testing::TestWithParam<OutScheme> {
 protected:
  static std::vector<Named> names() { return parsed(trees().at(to_string(GetParam()))); }
  static int joint(const Bvh& bvh, int smpl) {
    for (const Named& named : names())
      if (named.smpl == smpl) return bvh.joint(named.name);
    return -1;
  }
};

TEST_P(Skeletons, HaveTheNamesAndTheTreeOfTheProgram) {
  const Bvh bvh = parse_bvh(bvh_text(clip_of_another_body(3), {}, GetParam()), "x.bvh");
  const std::vector<Named> wanted = names();
  ASSERT_EQ(bvh.joints.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const BvhJoint& found = bvh.joints[i];
    EXPECT_EQ(found.name, wanted[i].name);
    EXPECT_EQ(found.parent < 0 ? "" : bvh.joints[static_cast<std::size_t>(found.parent)].name,
              wanted[i].parent)
        << found.name;
  }
}

TEST_P(Skeletons, KeepEveryJointOfABvhWhereTheClipHasIt) {
  for (const Clip& clip : {clip_of_another_body(4), clip_of_the_mean_body(5)}) {
    for (const BvhUnit unit : {BvhUnit::centimetres, BvhUnit::metres}) {
      const double per_metre = unit == BvhUnit::metres ? 1 : 100;
      const Bvh bvh = parse_bvh(bvh_text(clip, unit, GetParam()), "x.bvh");
      ASSERT_EQ(bvh.frames(), clip.frames());
      BvhPose pose;
      for (Eigen::Index t = 0; t < clip.frames(); ++t) {
        pose_bvh(bvh, t, pose);
        const JointPositions truth = joint_positions(clip, t);
        for (const Named& named : names()) {
          if (named.smpl < 0) continue;
          const auto i = static_cast<std::size_t>(bvh.joint(named.name));
          EXPECT_LT((pose.positions[i] / per_metre - truth.row(named.smpl).transpose()).norm(),
                    1e-6)
              << named.name << " frame " << t;
        }
      }
    }
  }
}

TEST_P(Skeletons, KeepEveryJointOfAGlbWhereTheClipHasIt) {
  const Clip clip = clip_of_another_body(6);
  const GlbFile file(glb_bytes(clip, GetParam()));
  std::map<std::string, std::size_t> nodes;
  for (std::size_t i = 0; i < file.json["nodes"].size(); ++i)
    EXPECT_TRUE(nodes.emplace(file.json["nodes"][i]["name"], i).second);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const GlbFile::Pose pose = file.pose(static_cast<std::size_t>(t));
    const JointPositions truth = joint_positions(clip, t);
    for (const Named& named : names()) {
      ASSERT_EQ(nodes.count(named.name), 1u) << named.name;
      if (named.smpl < 0) continue;
      const Float3& at = pose.positions[nodes[named.name]];
      EXPECT_LT((Eigen::RowVector3d(at[0], at[1], at[2]) - truth.row(named.smpl)).norm(), 1e-5)
          << named.name << " frame " << t;
    }
  }
}

// All rotations zero: arms to the sides or 45 degrees down, legs straight down, soles on the floor.
TEST_P(Skeletons, StandInTheirRestPose) {
  for (const Clip& clip : {clip_of_another_body(7), clip_of_the_mean_body(8)}) {
    const Bvh bvh = parse_bvh(bvh_text(clip, BvhUnit::metres, GetParam()), "x.bvh");
    const BvhPose rest = rest_bvh(bvh);
    const auto at = [&](int smpl) {
      const int index = joint(bvh, smpl);
      EXPECT_GE(index, 0) << smpl;
      return rest.positions[static_cast<std::size_t>(index)];
    };
    const auto direction = [&](int from, int to) { return (at(to) - at(from)).normalized(); };
    const double down = GetParam() == OutScheme::unreal ? std::sqrt(0.5) : 0;
    for (const int side : {0, 1}) {
      const Eigen::Vector3d arm((side == 0 ? 1 : -1) * std::sqrt(1 - down * down), -down, 0);
      EXPECT_LT((direction(16 + side, 18 + side) - arm).norm(), 1e-6);
      EXPECT_LT((direction(18 + side, 20 + side) - arm).norm(), 1e-6);
      EXPECT_LT((direction(1 + side, 4 + side) + Eigen::Vector3d::UnitY()).norm(), 1e-6);
      EXPECT_LT((direction(4 + side, 7 + side) + Eigen::Vector3d::UnitY()).norm(), 1e-6);
      EXPECT_GT(direction(7 + side, 10 + side).z(), 0.7);
      // The hand's bone goes on along the arm.
      const int wrist = joint(bvh, 20 + side), hand = joint(bvh, 22 + side);
      const Eigen::Vector3d tip =
          hand >= 0 ? Eigen::Vector3d(rest.positions[static_cast<std::size_t>(hand)] -
                                      rest.positions[static_cast<std::size_t>(wrist)])
                    : bvh.joints[static_cast<std::size_t>(wrist)].end_sites.at(0);
      EXPECT_LT((tip.normalized() - arm).norm(), 1e-5);
    }
    EXPECT_GT(direction(0, 15).y(), 0.95);
    EXPECT_GT(at(1).x(), at(2).x());
    EXPECT_NEAR(std::min(at(10).y(), at(11).y()), kSoleBelowFoot, 1e-6);
    // A root above the pelvis lies on the ground.
    if (names()[0].smpl < 0) {
      EXPECT_LT(rest.positions[0].norm(), 1e-6);
    }
  }
}

TEST_P(Skeletons, PutTheirOwnJointsOnTheLine) {
  const Clip clip = clip_of_another_body(9);
  const Bvh bvh = parse_bvh(bvh_text(clip, BvhUnit::metres, GetParam()), "x.bvh");
  BvhPose pose;
  pose_bvh(bvh, Eigen::Index{2}, pose);
  const JointPositions truth = joint_positions(clip, 2);
  const auto middle = [&](int a, int b) {
    return Eigen::Vector3d(0.5 * (truth.row(a) + truth.row(b)).transpose());
  };
  std::map<std::string, Eigen::Vector3d> wanted;
  if (GetParam() == OutScheme::rokoko) wanted["Spine4"] = middle(9, 12);
  if (GetParam() == OutScheme::cmu) {
    wanted["Neck1"] = middle(12, 15);
    wanted["LHipJoint"] = wanted["RHipJoint"] = truth.row(0).transpose();
  }
  if (GetParam() == OutScheme::rokoko) wanted["Root"] = Eigen::Vector3d::Zero();
  if (GetParam() == OutScheme::unreal) wanted["root"] = Eigen::Vector3d::Zero();
  for (const auto& [name, place] : wanted)
    EXPECT_LT((pose.positions[static_cast<std::size_t>(bvh.joint(name))] - place).norm(), 1e-6)
        << name;
}

// The skinned vertices of the .glb, by the specification's formula, are those of the program's own
// figure: exactly where one joint carries a vertex, nearly where two share it.
TEST_P(Skeletons, CarryTheFigure) {
  Random random(10);
  Clip clip = random_clip(random, 2, 30, 0.6);
  const GlbFile file(glb_bytes(clip, GetParam()));
  const Json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  const std::vector<double> points = file.numbers(attributes["POSITION"]);
  const std::vector<double> normals = file.numbers(attributes["NORMAL"]);
  const std::vector<double> joints = file.numbers(attributes["JOINTS_0"]);
  const std::vector<double> weights = file.numbers(attributes["WEIGHTS_0"]);
  const std::vector<double> inverse = file.numbers(file.json["skins"][0]["inverseBindMatrices"]);
  // The rest pose stands on the ground.
  double lowest = 1;
  for (std::size_t i = 1; i < points.size(); i += 3) lowest = std::min(lowest, points[i]);
  EXPECT_NEAR(lowest, 0, 0.004);
  const GlbFile::Pose pose = file.pose(1);
  MeshPoints wanted, wanted_normals;
  pose_body(clip, 1, wanted, wanted_normals);
  ASSERT_EQ(points.size(), static_cast<std::size_t>(wanted.size()));
  std::size_t exact = 0;
  for (std::size_t v = 0; v < points.size() / 3; ++v) {
    Float3 sum = {0, 0, 0};
    int shares = 0, wrist = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (weights[4 * v + k] == 0) continue;
      ++shares;
      const auto j = static_cast<std::size_t>(joints[4 * v + k]);
      const std::size_t node = file.json["skins"][0]["joints"][j];
      const double* m = inverse.data() + 16 * j;
      Float3 bound;
      for (std::size_t i = 0; i < 3; ++i)
        bound[i] = points[3 * v + i] + m[12 + i];  // the bind pose has no rotations
      const Float3 turned = GlbFile::rotate(pose.turns[node], bound);
      for (std::size_t i = 0; i < 3; ++i)
        sum[i] += weights[4 * v + k] * (turned[i] + pose.positions[node][i]);
    }
    const BodyMesh::Carried& carried = body_mesh().carried[v];
    for (const auto joint : carried.joints) wrist += joint >= 22;
    const double apart = (Eigen::RowVector3d(sum[0], sum[1], sum[2]) -
                          wanted.row(static_cast<Eigen::Index>(v)).cast<double>())
                             .norm();
    if (wrist > 0) continue;  // where the scheme has no such joint the wrist carries it
    EXPECT_LT(apart, shares == 1 ? 1e-5 : 0.02) << v;
    exact += shares == 1;
  }
  EXPECT_GT(exact, points.size() / 6);
}

std::string scheme_name(const testing::TestParamInfo<OutScheme>& info) {
  return to_string(info.param);
}

// Recognised again like anybody's file. Rokoko's trunk has a joint more than SMPL's: its bend is
// not divided the same way: 2 cm in a dance, 6 in these random poses.
TEST_P(Skeletons, ComeBackThroughTheReaders) {
  ::setenv("MOCAPLM_SCENE", MOCAPLM_BINARY_DIR "/mocaplm-scene", 0);
  Random random(17);
  Clip clip = resample(random_clip(random, 4, 3, 1), 30);
  clip.trans.col(1).array() += 1;
  const double most = GetParam() == OutScheme::rokoko ? 0.07 : 1e-4;
  Scratch scratch;
  WriteOptions options;
  options.skeleton = GetParam();
  for (const char* name : {"back.bvh", "back.glb"}) {
    write_clip(scratch / name, clip, options);
    const Clip back = read_clip(scratch / name);
    ASSERT_EQ(back.frames(), clip.frames());
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      // Hands are not joints of every skeleton.
      const JointPositions apart = joint_positions(back, t) - joint_positions(clip, t);
      EXPECT_LT(apart.topRows(22).rowwise().norm().maxCoeff(), most) << name << " frame " << t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Skeletons,
                         testing::Values(OutScheme::mixamo, OutScheme::unity, OutScheme::unreal,
                                         OutScheme::vrm, OutScheme::rokoko, OutScheme::cmu),
                         scheme_name);

// What is written comes back: names that are known without a map.
TEST(SkeletonsRead, ComeBackAsTheMotionTheyWere) {
  Random random(12);
  Clip clip = random_clip(random, 6, 30);
  clip.poses.rightCols<6>().setZero();  // hands' own joints turn nothing
  for (const OutScheme scheme : {OutScheme::smpl, OutScheme::mixamo, OutScheme::cmu}) {
    const Bvh bvh = parse_bvh(bvh_text(clip, {}, scheme), "x.bvh");
    RetargetReport report;
    const Clip back = retarget_bvh(bvh, "x.bvh", {}, &report);
    EXPECT_EQ(report.scheme, to_string(scheme));
    for (Eigen::Index t = 0; t < clip.frames(); ++t)
      EXPECT_LT((joint_positions(back, t) - joint_positions(clip, t)).cwiseAbs().maxCoeff(), 1e-3)
          << to_string(scheme) << " frame " << t;
  }
}

TEST(SkeletonsRead, AreKnownByName) {
  EXPECT_EQ(out_scheme_of("unreal"), OutScheme::unreal);
  EXPECT_NE(refusal<UsageError>([] { out_scheme_of("mixame"); }).find("mixamo"), std::string::npos);
}

TEST(WriteOptionsOf, RefuseWhatHasNoEffect) {
  const auto refused = [](const char* file, OutScheme skeleton, BvhUnit unit) {
    WriteOptions options;
    options.skeleton = skeleton;
    options.bvh_unit = unit;
    return refusal<UsageError>([&] { check_written_format(file, options); });
  };
  const auto cm = BvhUnit::centimetres, m = BvhUnit::metres;
  EXPECT_TRUE(contains(refused("x.npz", OutScheme::mixamo, cm), ".bvh or a .glb"));
  EXPECT_TRUE(contains(refused("x.csv", OutScheme::cmu, cm), ".bvh or a .glb"));
  EXPECT_TRUE(contains(refused("x.vrma", OutScheme::unity, cm), "vrm"));
  EXPECT_TRUE(contains(refused("x.glb", OutScheme::smpl, m), "unit"));
  EXPECT_TRUE(contains(refused("x.npz", OutScheme::smpl, m), "unit"));
  WriteOptions vrm;
  vrm.skeleton = OutScheme::vrm;
  check_written_format("x.vrma", vrm);
  vrm.bvh_unit = m;
  check_written_format("x.BVH", vrm);
}

}  // namespace
}  // namespace mocaplm::skeletons_test
