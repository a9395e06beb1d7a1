#include "motion/formats/glb.h"

#include <gtest/gtest.h>

#include "motion/body_mesh.h"
#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "motion/helpers.h"
#include "motion/skeleton.h"
#include "support/glb_file.h"

namespace mocaplm::glb_test {
namespace {

// Rotations of all kinds: unrelated frames, turns beyond pi, none at all, slow ones.
Clip difficult_clip(Eigen::Index frames, double fps) {
  Random random(5);
  Clip clip = random_clip(random, frames, fps, 6.5);
  for (Eigen::Index t = 1; t < frames; ++t)
    for (const int joint : {3, 18, 19})
      clip.poses.row(t).segment<3>(3 * joint) = 1.01 * clip.poses.row(t - 1).segment<3>(3 * joint);
  clip.poses.middleCols<6>(3 * 22).setZero();
  clip.name =
      "ein \"Tanz\" \xc3\xbc"
      "ber 2 m";
  clip.labels = {{"genre", "waack"}};
  return clip;
}

double distance(const Float3& a, const Eigen::RowVector3d& b) {
  return (Eigen::RowVector3d(a[0], a[1], a[2]) - b).norm();
}

TEST(Glb, MovesAsTheForwardKinematicsSay) {
  const Clip clip = difficult_clip(80, 29.97);
  const GlbFile file(glb_bytes(clip));
  const Json& sampler = file.json["animations"][0]["samplers"][0];
  const std::vector<double> times = file.numbers(sampler["input"]);
  ASSERT_EQ(times.size(), 80u);
  Random random(6);
  for (int i = 0; i < 20; ++i) {
    const auto frame = i == 0 ? 0 : i == 1 ? 79 : random.below(80);
    EXPECT_NEAR(times[frame], static_cast<double>(frame) / 29.97, 1e-6);
    const GlbFile::Pose pose = file.pose(frame);
    const JointPositions truth = joint_positions(clip, static_cast<Eigen::Index>(frame));
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_EQ(file.json["nodes"][j]["name"], joint_names()[j]);
      ASSERT_LT(distance(pose.positions[j], truth.row(static_cast<Eigen::Index>(j))), 1e-5)
          << frame << " " << joint_names()[j];
    }
  }
}

// Between two frames a player goes the straight way from one quaternion to the next.
TEST(Glb, QuaternionsAreOfLengthOneAndStayOnOneHemisphere) {
  const GlbFile file(glb_bytes(difficult_clip(60, 60)));
  const Json& animation = file.json["animations"][0];
  int rotations = 0;
  for (const Json& channel : animation["channels"]) {
    const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
    EXPECT_EQ(sampler["interpolation"], "LINEAR");
    if (channel["target"]["path"] != "rotation") continue;
    ++rotations;
    const std::vector<double> q = file.numbers(sampler["output"]);
    ASSERT_EQ(q.size(), 240u);
    for (std::size_t i = 0; i < q.size(); i += 4) {
      double length = 0, with_last = 0;
      for (std::size_t k = i; k < i + 4; ++k) {
        length += q[k] * q[k];
        with_last += i == 0 ? 0 : q[k] * q[k - 4];
      }
      ASSERT_NEAR(length, 1, 1e-6);
      ASSERT_GE(with_last, 0);
    }
  }
  EXPECT_EQ(rotations, kJoints);
}

// The skinned vertices, by the specification's formula, are those of the program's own figure.
TEST(Glb, SkinFollowsTheJoints) {
  const Clip clip = difficult_clip(3, 30);
  const GlbFile file(glb_bytes(clip));
  const Json& primitive = file.json["meshes"][0]["primitives"][0];
  const Json& attributes = primitive["attributes"];
  const std::vector<double> points = file.numbers(attributes["POSITION"]);
  const std::vector<double> joints = file.numbers(attributes["JOINTS_0"]);
  const std::vector<double> weights = file.numbers(attributes["WEIGHTS_0"]);
  const std::vector<double> inverse = file.numbers(file.json["skins"][0]["inverseBindMatrices"]);
  const GlbFile::Pose pose = file.pose(1);
  MeshPoints wanted, normals;
  pose_body(clip, 1, wanted, normals);
  ASSERT_EQ(points.size(), static_cast<std::size_t>(wanted.size()));
  for (std::size_t v = 0; v < points.size() / 3; ++v) {
    Float3 sum = {0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto joint = static_cast<std::size_t>(joints[4 * v + k]);
      const double* m = inverse.data() + 16 * joint;  // column after column
      Float3 bound;
      for (std::size_t i = 0; i < 3; ++i)
        bound[i] = m[i] * points[3 * v] + m[4 + i] * points[3 * v + 1] +
                   m[8 + i] * points[3 * v + 2] + m[12 + i];
      const Float3 turned = GlbFile::rotate(pose.turns[joint], bound);
      for (std::size_t i = 0; i < 3; ++i)
        sum[i] += weights[4 * v + k] * (turned[i] + pose.positions[joint][i]);
    }
    ASSERT_LT(distance(sum, wanted.row(static_cast<Eigen::Index>(v)).cast<double>()), 1e-5) << v;
  }
  for (const double index : file.numbers(primitive["indices"])) ASSERT_LT(index, wanted.rows());
}

TEST(Glb, SaysWhatItIs) {
  const Clip clip = difficult_clip(2, 24);
  const Json json = GlbFile(glb_bytes(clip)).json;
  EXPECT_EQ(json["asset"]["version"], "2.0");
  EXPECT_EQ(json["asset"]["generator"].get<std::string>().rfind("mocaplm ", 0), 0u);
  EXPECT_EQ(json["animations"][0]["name"], clip.name);
  EXPECT_EQ(json["animations"][0]["extras"]["fps"], 24);
  EXPECT_EQ(json["animations"][0]["extras"]["labels"]["genre"], "waack");
  // The rest pose stands on the ground.
  const Json& primitive = json["meshes"][0]["primitives"][0];
  const std::size_t position = primitive["attributes"]["POSITION"];
  EXPECT_NEAR(json["accessors"][position]["min"][1].get<double>(), 0, 0.004);
}

TEST(Glb, TakesOneFrameAndAnyName) {
  Clip clip = difficult_clip(1, 30);
  clip.name = "\xff\xfe not UTF-8";
  const GlbFile one(glb_bytes(clip));
  EXPECT_EQ(one.numbers(one.json["animations"][0]["samplers"][0]["input"]), std::vector<double>{0});
  clip.name.clear();
  EXPECT_EQ(GlbFile(glb_bytes(clip)).json["animations"][0]["name"], "motion");
}

TEST(Glb, RefusesAnUnsoundClip) {
  const Scratch scratch;
  Clip clip = difficult_clip(2, 30);
  clip.poses(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_glb(scratch / "x.glb", clip), DataError);
  EXPECT_FALSE(std::filesystem::exists(scratch / "x.glb"));
}

TEST(Glb, IsToldByItsFirstBytes) {
  const Scratch scratch;
  write_clip(scratch / "x.GLB", difficult_clip(2, 30));
  const std::string bytes = read_file(scratch / "x.GLB");
  EXPECT_TRUE(contains(refusal([&] { read_clip(scratch.put("y.bvh", bytes)); }), "glTF"));
  EXPECT_TRUE(contains(
      refusal<UsageError>([&] { write_clip(scratch / "x.fbx", difficult_clip(2, 30)); }), ".glb"));
}

}  // namespace
}  // namespace mocaplm::glb_test
