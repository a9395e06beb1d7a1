// Scene files through mocaplm-scene: this program's own .glb, what Debian's assimp makes of it,
// trees at random against a plain evaluation of their nodes.
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/find_program.h"
#include "motion/formats/fbx_text.h"
#include "motion/formats/formats.h"
#include "motion/formats/gltf_file.h"
#include "motion/formats/helpers.h"
#include "motion/formats/scene_process.h"
#include "motion/formats/scene_takes.h"
#include "motion/helpers.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "support/run_program.h"

namespace mocaplm::scene_files_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

class SceneFiles : public testing::Test {
 protected:
  void SetUp() override { ::setenv("MOCAPLM_SCENE", MOCAPLM_BINARY_DIR "/mocaplm-scene", 0); }
  Bvh only_take(const std::filesystem::path& path) {
    SceneMotions motions = scene_motions(read_scene(path), path.string());
    EXPECT_EQ(motions.motions.size(), 1u);
    return std::move(motions.motions.front().bvh);
  }
  Scratch scratch_;
  Random random_{7};
};

// ---- our own figure ----

Clip moving_clip(double fps) {
  Random random(11);
  Clip keys = random_clip(random, 5, 3, 1.2);
  keys.trans.col(1).array() += 1;
  Clip clip = slice(resample(keys, fps), 0, 40);
  clip.name = "moving";
  return clip;
}

void expect_same_joints(const Clip& clip, const Clip& truth, double tolerance) {
  ASSERT_EQ(clip.frames(), truth.frames());
  for (Eigen::Index t = 0; t < truth.frames(); ++t)
    ASSERT_LT((joint_positions(clip, t) - joint_positions(truth, t)).cwiseAbs().maxCoeff(),
              tolerance)
        << t;
}

TEST_F(SceneFiles, OwnGlbComesBack) {
  for (const double fps : {24.0, 29.97, 60.0, 120.0}) {
    const Clip clip = moving_clip(fps);
    write_clip(scratch_ / "moving.glb", clip);
    ReadReport report;
    const Clip back = read_clip(scratch_ / "moving.glb", {}, &report);
    EXPECT_EQ(back.name, "moving");
    EXPECT_NEAR(back.fps, fps, 1e-4);
    EXPECT_NEAR(report.retarget.unit, 1, 1e-12);
    EXPECT_EQ(report.remarks.size(), 0u);
    expect_same_joints(back, clip, 1e-4);
  }
}

// assimp's writers of FBX and COLLADA make files that its own readers refuse or read at other
// times.
TEST_F(SceneFiles, OwnFigureComesBackFromAssimpsGltf) {
  const std::string assimp = find_program("assimp");
  if (assimp.empty()) GTEST_SKIP() << "no assimp: apt-get install assimp-utils";
  const Clip clip = moving_clip(30);
  const std::string glb = scratch_ / "moving.glb", file = scratch_ / "a.gltf";
  write_clip(glb, clip);
  const Ran ran = run_shell(assimp + " export '" + glb + "' '" + file + "' -fgltf2");
  ASSERT_EQ(ran.code, 0) << ran.text;
  const Clip back = read_clip(file);
  EXPECT_NEAR(back.fps, 30, 1e-3);
  expect_same_joints(back, clip, 1e-3);
}

Vector3d rest_bone(int joint) {
  const int parent = joint_parents()[static_cast<std::size_t>(joint)];
  Vector3d bone = rest_joints().row(joint).transpose();
  if (parent >= 0) bone -= rest_joints().row(parent).transpose();
  return bone;
}

Matrix3d turn_of(const Clip& clip, Eigen::Index frame, int joint) {
  return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * joint).transpose())
      .toRotationMatrix();
}

TEST_F(SceneFiles, OwnFigureComesBackFromAnFbx) {
  const Clip clip = moving_clip(60);
  std::vector<FbxBone> bones;
  for (int j = 0; j < kJoints; ++j) {
    FbxBone bone;
    bone.name = joint_names()[static_cast<std::size_t>(j)];
    bone.parent = joint_parents()[static_cast<std::size_t>(j)];
    bone.translation = 100 * rest_bone(j);
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const Vector3d zyx = euler_from_matrix(turn_of(clip, t, j), {2, 1, 0});
      bone.rotations.push_back(zyx.reverse() * (180 / std::acos(-1.0)));
      if (j == 0)
        bone.translations.push_back(bone.translation + 100 * clip.trans.row(t).transpose());
    }
    bones.push_back(bone);
  }
  FbxSettings settings;
  settings.fps = 60;
  const Clip back = read_clip(scratch_.put("moving.fbx", FbxText(bones, settings).text()));
  EXPECT_EQ(back.fps, 60);
  EXPECT_EQ(back.name, "moving");
  expect_same_joints(back, clip, 1e-3);
}

// As Blender writes it: centimetres, Z up, a matrix for each joint in each frame.
class DaeText {
 public:
  explicit DaeText(const Clip& clip) : clip_(clip) {
    head_.precision(9);
    tree_.precision(9);
  }
  std::string text() {
    nodes(0);
    return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<COLLADA "
           "xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n"
           "<asset><unit name=\"centimeter\" meter=\"0.01\"/><up_axis>Z_UP</up_axis></asset>\n"
           "<library_animations>\n" +
           head_.str() + "</library_animations>\n<library_visual_scenes><visual_scene id=\"S\">\n" +
           tree_.str() +
           "</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene "
           "url=\"#S\"/></scene>\n</COLLADA>\n";
  }

 private:
  // In the file's world: x, -z, y of ours.
  static void add(std::ostream& out, Matrix3d turn, Vector3d place) {
    Matrix3d to_file;
    to_file << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    turn = to_file * turn * to_file.transpose();
    place = 100 * (to_file * place);
    for (int row = 0; row < 3; ++row)
      out << turn(row, 0) << ' ' << turn(row, 1) << ' ' << turn(row, 2) << ' ' << place[row] << ' ';
    out << "0 0 0 1 ";
  }
  void nodes(int joint) {
    const std::string name = joint_names()[static_cast<std::size_t>(joint)];
    tree_ << "<node id=\"j_" << name << "\" name=\"" << name << "\" sid=\"" << name
          << "\" type=\"JOINT\"><matrix sid=\"transform\">";
    add(tree_, Matrix3d::Identity(), rest_bone(joint));
    tree_ << "</matrix>\n";
    animation(joint, name);
    for (int child = joint + 1; child < kJoints; ++child)
      if (joint_parents()[static_cast<std::size_t>(child)] == joint) nodes(child);
    tree_ << "</node>\n";
  }
  void animation(int joint, const std::string& name) {
    const Eigen::Index n = clip_.frames();
    head_ << "<animation id=\"a_" << name << "\"><source id=\"a_" << name
          << "-i\"><float_array id=\"a_" << name << "-ia\" count=\"" << n << "\">";
    for (Eigen::Index t = 0; t < n; ++t) head_ << static_cast<double>(t) / clip_.fps << ' ';
    end_source(name + "-ia", n, 1, "TIME", "float");
    head_ << "<source id=\"a_" << name << "-o\"><float_array id=\"a_" << name << "-oa\" count=\""
          << 16 * n << "\">";
    for (Eigen::Index t = 0; t < n; ++t)
      add(head_, turn_of(clip_, t, joint),
          rest_bone(joint) +
              (joint == 0 ? Vector3d(clip_.trans.row(t).transpose()) : Vector3d(Vector3d::Zero())));
    end_source(name + "-oa", n, 16, "TRANSFORM", "float4x4");
    head_ << "<sampler id=\"a_" << name << "-s\"><input semantic=\"INPUT\" source=\"#a_" << name
          << "-i\"/><input semantic=\"OUTPUT\" source=\"#a_" << name
          << "-o\"/></sampler><channel source=\"#a_" << name << "-s\" target=\"j_" << name
          << "/transform\"/></animation>\n";
  }
  void end_source(const std::string& array, Eigen::Index count, int stride, const char* name,
                  const char* type) {
    head_ << "</float_array><technique_common><accessor source=\"#a_" << array << "\" count=\""
          << count << "\" stride=\"" << stride << "\"><param name=\"" << name << "\" type=\""
          << type << "\"/></accessor></technique_common></source>";
  }

  const Clip& clip_;
  std::ostringstream head_, tree_;
};

TEST_F(SceneFiles, OwnFigureComesBackFromADae) {
  const Clip clip = moving_clip(30);
  const Clip back = read_clip(scratch_.put("moving.dae", DaeText(clip).text()));
  EXPECT_EQ(back.fps, 30);
  expect_same_joints(back, clip, 1e-3);
}

// ---- trees at random ----

Eigen::Quaterniond random_turn(Random& random, double most = 3) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0, most), random_direction(random)));
}

// An armature with a turn and a scale of its own, a tree of bones below it, and nodes that have
// nothing to do with them.
MovingTree random_tree(Random& random, int bones, int frames) {
  MovingTree tree = {{"World", -1, {}, {}}, {"Lamp holder", 0, {{5, 5, 5}, {}, {}}, {}}};
  MovingNode armature{"Armature", 0, {}, {}};
  armature.still = {Vector3d(0.1, 0.2, 0.3), random_turn(random), Vector3d::Constant(0.01)};
  tree.push_back(armature);
  for (int i = 0; i < bones; ++i) {
    MovingNode bone;
    bone.name = "bone" + std::to_string(i);
    bone.parent = i == 0 ? 2 : 3 + static_cast<int>(random.below(static_cast<std::uint64_t>(i)));
    bone.still = {20 * random_direction(random), random_turn(random),
                  Vector3d::Constant(random.uniform(0.8, 1.25))};
    Trs now = bone.still;
    for (int t = 0; t < frames; ++t) {
      now.r = now.r * random_turn(random, 0.3);
      if (i == 0) now.t += 3 * random_direction(random);
      bone.frames.push_back(now);
    }
    tree.push_back(bone);
  }
  return tree;
}

Matrix3d turn_of(const Matrix4d& place) {
  return place.topLeftCorner<3, 3>() / std::cbrt(place.topLeftCorner<3, 3>().determinant());
}

// Joint `name` of `bvh` in a frame (-1: at rest) lies at `place`, turned from `rest` as it is
// there.
void expect_place(const Bvh& bvh, const BvhPose& pose, const std::string& name,
                  const Matrix4d& place, const Matrix4d& rest, double tolerance) {
  const int index = bvh.joint(name);
  ASSERT_GE(index, 0) << name;
  const auto j = static_cast<std::size_t>(index);
  ASSERT_LT((pose.positions[j] - place.topRightCorner<3, 1>()).norm(), tolerance) << name;
  const Matrix3d turn = turn_of(place) * turn_of(rest).transpose();
  ASSERT_LT((pose.rotations[j] - turn).cwiseAbs().maxCoeff(), tolerance) << name;
}

constexpr int kFrames = 12, kBones = 20;

TEST_F(SceneFiles, RandomGltfTreesAreEvaluatedAsTheirNodes) {
  for (int trial = 0; trial < 6; ++trial) {
    SCOPED_TRACE(trial);
    const MovingTree tree = random_tree(random_, kBones, kFrames);
    GltfFile file(tree);
    std::vector<double> times;
    for (int t = 0; t < kFrames; ++t) times.push_back((t + 1) / 30.0);
    file.animate(tree, times, "walk");
    const Bvh bvh = only_take(scratch_.put("tree.gltf", file.text()));
    EXPECT_EQ(bvh.fps, 30);
    ASSERT_EQ(bvh.frames(), kFrames);
    EXPECT_EQ(bvh.joints.size(), static_cast<std::size_t>(kBones));
    const std::vector<Matrix4d> rest = places(tree, -1);
    BvhPose pose = rest_bvh(bvh);
    for (int t = -1; t < kFrames; ++t) {
      if (t >= 0) pose_bvh(bvh, t, pose);
      const std::vector<Matrix4d> now = places(tree, t);
      for (std::size_t i = 3; i < tree.size(); ++i)
        expect_place(bvh, pose, tree[i].name, now[i], rest[i], 1e-5);
    }
  }
}

TEST_F(SceneFiles, TheSkinSaysTheRestPose) {
  // What the inverse bind matrices are seen from: the world, and exporters' other choices.
  Matrix4d turned = Matrix4d::Identity();
  turned.topLeftCorner<3, 3>() = 100 * random_turn(random_).toRotationMatrix();
  turned(1, 3) = 3;
  for (const Matrix4d& seen : {Matrix4d(Matrix4d::Identity()), turned}) {
    MovingTree tree = random_tree(random_, kBones, kFrames);
    const std::vector<Matrix4d> bound = places(tree, -1);
    // The nodes stand in the first frame of the motion; the hips are where they were bound.
    for (MovingNode& node : tree)
      if (!node.frames.empty() && node.name != "bone0") node.still = node.frames.front();
    GltfFile file(tree);
    std::vector<double> times;
    for (int t = 0; t < kFrames; ++t) times.push_back(t / 24.0);
    file.animate(tree, times, "walk");
    std::vector<int> bones;
    std::vector<Matrix4d> binding;
    for (std::size_t i = 3; i < tree.size(); ++i) {
      bones.push_back(static_cast<int>(i));
      binding.push_back(bound[i]);
    }
    file.skin(bones, binding, seen);
    const Bvh bvh = only_take(scratch_.put("skin.gltf", file.text()));
    BvhPose pose = rest_bvh(bvh);
    for (std::size_t i = 3; i < tree.size(); ++i)
      expect_place(bvh, pose, tree[i].name, bound[i], bound[i], 1e-4);
    for (int t = 0; t < kFrames; ++t) {
      pose_bvh(bvh, t, pose);
      const std::vector<Matrix4d> now = places(tree, t);
      for (std::size_t i = 3; i < tree.size(); ++i)
        expect_place(bvh, pose, tree[i].name, now[i], bound[i], 1e-4);
    }
  }
}

// ---- FBX ----

std::vector<FbxBone> random_fbx(Random& random, bool pivots) {
  const auto angles = [&](double most) {
    return Vector3d(random.uniform(-most, most), random.uniform(-most, most),
                    random.uniform(-most, most));
  };
  std::vector<FbxBone> bones;
  for (int i = 0; i < kBones; ++i) {
    FbxBone bone;
    bone.name = "bone" + std::to_string(i);
    bone.parent = i == 0 ? -1 : static_cast<int>(random.below(static_cast<std::uint64_t>(i)));
    bone.translation = 20 * random_direction(random);
    bone.rotation = angles(40);
    if (pivots) {
      bone.pre = angles(170);
      bone.post = i % 3 == 0 ? angles(90) : Vector3d::Zero();
      bone.order = static_cast<int>(random.below(6));
    }
    Vector3d turn = bone.rotation, place = bone.translation;
    for (int t = 0; t < kFrames; ++t) {
      bone.rotations.push_back(turn += angles(8));
      if (i == 0) bone.translations.push_back(place += random_direction(random));
    }
    bones.push_back(bone);
  }
  return bones;
}

TEST_F(SceneFiles, RandomFbxTreesAreEvaluatedAsTheirBones) {
  for (const bool pivots : {false, true})
    for (const double unit : {1.0, 100.0})
      for (const bool z_up : {false, true}) {
        SCOPED_TRACE(std::to_string(pivots) + " " + std::to_string(unit) + " " +
                     std::to_string(z_up));
        const std::vector<FbxBone> bones = random_fbx(random_, pivots);
        FbxSettings settings;
        settings.unit = unit;
        settings.z_up = z_up;
        settings.fps = 60;
        const Bvh bvh = only_take(scratch_.put("tree.fbx", FbxText(bones, settings).text()));
        EXPECT_EQ(bvh.fps, 60);
        ASSERT_EQ(bvh.frames(), kFrames);
        // Metres, Y up: z up is turned by -90 degrees about x.
        Matrix4d world = Matrix4d::Identity();
        world.topLeftCorner<3, 3>() *= unit / 100;
        if (z_up)
          world.topLeftCorner<3, 3>() *=
              Eigen::AngleAxisd(-std::acos(-1.0) / 2, Vector3d::UnitX()).toRotationMatrix();
        const std::vector<Matrix4d> rest = fbx_places(bones, -1);
        BvhPose pose = rest_bvh(bvh);
        for (int t = -1; t < kFrames; ++t) {
          if (t >= 0) pose_bvh(bvh, t, pose);
          const std::vector<Matrix4d> now = fbx_places(bones, t);
          for (std::size_t i = 0; i < bones.size(); ++i)
            expect_place(bvh, pose, bones[i].name, world * now[i], world * rest[i],
                         1e-4 * std::max(1.0, unit / 10));
        }
      }
}

}  // namespace
}  // namespace mocaplm::scene_files_test
