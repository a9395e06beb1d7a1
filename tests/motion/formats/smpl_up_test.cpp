// Which way is up in SMPL files, and where the pelvis then lies.
#include "motion/formats/up_axis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "motion/formats/npy.h"
#include "motion/formats/npz.h"
#include "motion/formats/smpl_files.h"
#include "motion/formats/zip_file.h"
#include "motion/helpers.h"
#include "motion/skeleton.h"

namespace mocaplm::smpl_up_test {
namespace {

std::filesystem::path shared_case(const std::string& name) {
  return std::filesystem::path(MOCAPLM_SOURCE_DIR) / ".." / "shared" / "cases" / name;
}

double lowest_foot(const Clip& clip, Eigen::Index frame) {
  const JointPositions joints = joint_positions(clip, frame);
  return std::min({joints(7, 1), joints(8, 1), joints(10, 1), joints(11, 1)});
}

// Forward kinematics in the file's own world, written plainly: SMPL's definition with matrices from
// Rodrigues' formula, the root about its rest pelvis.
JointPositions plain_joints(const double* pose, const Eigen::Vector3d& trans) {
  const auto rodrigues = [](const double* v) -> Eigen::Matrix3d {
    const Eigen::Vector3d r(v[0], v[1], v[2]);
    const double angle = r.norm();
    Eigen::Matrix3d k;
    k << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
    if (angle < 1e-12) return Eigen::Matrix3d::Identity() + k;
    k /= angle;
    return Eigen::Matrix3d::Identity() + std::sin(angle) * k + (1 - std::cos(angle)) * k * k;
  };
  const RestJoints& rest = rest_joints();
  std::array<Eigen::Matrix3d, kJoints> world;
  JointPositions joints(kJoints, 3);
  for (int j = 0; j < kJoints; ++j) {
    const int parent = joint_parents()[j];
    if (parent < 0) {
      world[j] = rodrigues(pose);
      joints.row(j) = rest.row(0) + trans.transpose();
      continue;
    }
    world[j] = world[parent] * (j < 22 ? rodrigues(pose + 3 * j) : Eigen::Matrix3d::Identity());
    joints.row(j) = joints.row(parent) +
                    (world[parent] * (rest.row(j) - rest.row(parent)).transpose()).transpose();
  }
  return joints;
}

TEST(SmplUp, ThePelvisOfAnAmassFileLiesWhereItsMarkersSay) {
  const auto path = shared_case("amass-zup-pelvis/standing.npz");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const Clip clip = read_clip(path),
             same = read_clip(shared_case("amass-zup-pelvis/standing_yup72.npz"));
  const JointPositions joints = joint_positions(clip, 0);
  EXPECT_NEAR(joints(0, 0), 0.500, 1e-3);
  EXPECT_NEAR(joints(0, 1), 0.950, 1e-3);
  EXPECT_NEAR(joints(0, 2), -0.250, 1e-3);
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    EXPECT_LT((joint_positions(clip, t) - joint_positions(same, t)).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_NEAR(lowest_foot(clip, 0), 0.030, 2e-3);
}

// All joints of a file, computed in its own world and turned rigidly, are our joints.
TEST(SmplUp, EveryJointOfEveryLayoutIsTheTurnedOne) {
  const Scratch scratch;
  Random random(31);
  for (const std::size_t columns : {66, 72, 156, 165, 0}) {  // 0: root_orient and pose_body
    const std::size_t width = columns == 0 ? 66 : columns;
    std::vector<double> poses(5 * width), trans(15);
    for (double& value : poses) value = random.uniform(-1.2, 1.2);
    for (double& value : trans) value = random.uniform(-2, 2);
    const double fps = 60;
    std::vector<std::pair<std::string, std::string>> entries = {
        {"trans.npy", npy_bytes(trans.data(), {5, 3})},
        {"mocap_framerate.npy", npy_bytes(&fps, {})}};
    if (columns > 0) {
      entries.emplace_back("poses.npy", npy_bytes(poses.data(), {5, width}));
    } else {
      std::vector<double> root, body;
      for (std::size_t t = 0; t < 5; ++t) {
        root.insert(root.end(), poses.begin() + t * 66, poses.begin() + t * 66 + 3);
        body.insert(body.end(), poses.begin() + t * 66 + 3, poses.begin() + t * 66 + 66);
      }
      entries.emplace_back("root_orient.npy", npy_bytes(root.data(), {5, 3}));
      entries.emplace_back("pose_body.npy", npy_bytes(body.data(), {5, 63}));
    }
    write_zip(scratch / "a.npz", entries);
    for (const std::string& name : up_axis_names()) {
      if (name == "auto") continue;
      ReadOptions options;
      options.up = up_axis_of(name);
      const Clip clip = read_clip(scratch / "a.npz", options);
      const Eigen::Matrix3d turn = turn_to_y_up(options.up);
      EXPECT_LT((turn * up_vector(options.up) - Eigen::Vector3d::UnitY()).norm(), 1e-12);
      EXPECT_NEAR(turn.determinant(), 1, 1e-12);
      for (Eigen::Index t = 0; t < 5; ++t) {
        const JointPositions file =
            plain_joints(&poses[static_cast<std::size_t>(t) * width],
                         Eigen::Vector3d(trans[3 * t], trans[3 * t + 1], trans[3 * t + 2]));
        const JointPositions ours = joint_positions(clip, t);
        // 22 joints: what follows in wide files are fingers, which are not kept.
        ASSERT_LT((ours - file * turn.transpose()).topRows(22).cwiseAbs().maxCoeff(), 1e-9)
            << columns << " columns, " << name;
      }
    }
  }
}

TEST(SmplUp, ACameraLooksAlongZWithYDown) {
  const auto path = shared_case("camera-y-down/incam.npz");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  ReadOptions options;
  options.up = UpAxis::minus_y;
  const JointPositions joints = joint_positions(read_clip(path, options), 0);
  EXPECT_LT((joints.row(15) - joints.row(0) - Eigen::RowVector3d(0.01, 0.58, 0.01)).norm(), 0.01);
}

bool remarked(const ReadMotion& motion, const std::string& kind) {
  for (const Remark& remark : motion.report.remarks)
    if (remark.kind == kind) return true;
  return false;
}

// Whatever the layout and the axis, a standing person stands.
TEST(SmplUp, TheMotionItselfSaysWhichAxisIsUp) {
  const Scratch scratch;
  const Clip walk = walker();
  for (const std::size_t columns : {66, 72, 156, 165})
    for (const std::string& name : up_axis_names()) {
      if (name == "auto") continue;
      write_zip(scratch / "a.npz", amass_entries(in_world(walk, up_axis_of(name)), columns));
      const ReadMotion motion = read_clips(scratch / "a.npz")[0];
      EXPECT_LT(apart(motion.clip, walk), 1e-9) << columns << " " << name;
      const bool usual = columns == 66 || name == (columns == 72 ? "y" : "z");
      EXPECT_EQ(remarked(motion, "up axis by the motion"), !usual) << columns << " " << name;
    }
}

TEST(SmplUp, IsAskedForWhereNeitherLayoutNorMotionSayIt) {
  const Scratch scratch;
  Clip tilted = walker();
  turn_world(tilted, matrix_from_axis_angle({0.8, 0.8, 0}));
  for (const std::size_t columns : {66, 165}) {
    write_zip(scratch / "a.npz", amass_entries(tilted, columns));
    EXPECT_TRUE(contains(refusal([&] { read_clip(scratch / "a.npz"); }), "--up"));
    ReadOptions options;
    options.up = UpAxis::y;
    EXPECT_LT(apart(read_clip(scratch / "a.npz", options), tilted), 1e-9);
  }
  // Layouts of one habit keep to it, and say that nobody could confirm it.
  write_zip(scratch / "a.npz", amass_entries(tilted, 72));
  EXPECT_LT(apart(read_clip(scratch / "a.npz"), tilted), 1e-9);
  EXPECT_TRUE(remarked(read_clips(scratch / "a.npz")[0], "up axis by the layout"));
}

// Upside down on the hands, and on the back on the floor: meant as they are.
TEST(SmplUp, HandstandsAndLyingPeopleStayAsTheyAre) {
  const Scratch scratch;
  Clip hands = walker();
  for (Eigen::Index t = 0; t < hands.frames(); ++t) {
    hands.poses(t, 3 * 16 + 2) = 1.4;
    hands.poses(t, 3 * 17 + 2) = -1.4;
  }
  turn_world(hands, turn_to_y_up(UpAxis::minus_y));
  write_zip(scratch / "a.npz", amass_entries(hands, 72));
  EXPECT_LT(apart(read_clip(scratch / "a.npz"), hands), 1e-9);
  Clip lying = walker();
  turn_world(lying, turn_to_y_up(UpAxis::z));
  lying.trans.col(1).setConstant(0.12 - rest_joints()(0, 1));
  lying.trans.col(2).array() += 2;
  write_zip(scratch / "a.npz", amass_entries(lying, 72));
  EXPECT_LT(apart(read_clip(scratch / "a.npz"), lying), 1e-9);
}

TEST(SmplUp, OurOwnFilesSayIt) {
  const Scratch scratch;
  const Clip down = in_world(walker(), UpAxis::minus_y);
  write_npz(scratch / "a.npz", down);
  const ReadMotion motion = read_clips(scratch / "a.npz")[0];
  EXPECT_TRUE(motion.clip.poses == down.poses && motion.clip.trans == down.trans);
  EXPECT_TRUE(motion.report.remarks.empty());
}

}  // namespace
}  // namespace mocaplm::smpl_up_test
