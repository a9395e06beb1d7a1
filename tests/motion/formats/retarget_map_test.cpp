#include "motion/formats/retarget_map.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/angles.h"
#include "common/files.h"
#include "common/json.h"
#include "motion/formats/retarget_helpers.h"

namespace mocaplm::retarget_map_test {
namespace {

class RetargetMaps : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(testing::TempDir()) /
            ("mocaplm_map_" +
             std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".json");
    for (int j = 0; j < 22; ++j) names_.push_back({j, "Bone " + std::to_string(j)});
    for (const auto& [joint, name] : names_)
      map_["joints"][joint_names()[static_cast<std::size_t>(joint)]] = name;
  }
  void TearDown() override { std::filesystem::remove(path_); }
  BvhOptions options() {
    save_json(path_, map_);
    BvhOptions options;
    options.map_file = path_.string();
    options.keep_path = true;  // hips stay where the source has them
    return options;
  }
  std::string map_error() {
    save_json(path_, map_);
    try {
      load_map(path_);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path path_;
  Names names_;
  Json map_;
  Random random_{31};
};

Matrix3d random_rotation(Random& random) {
  return matrix_from_axis_angle(random.uniform(0, 3) * random_direction(random));
}

TEST_F(RetargetMaps, ZeroPose) {
  const Rig rig = rig_of(names_, body(&random_));
  const Motion m = motion(random_);
  RetargetReport report;
  const Clip clip =
      retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig", options(), &report);
  EXPECT_EQ(report.scheme, path_.string());
  expect_same_motion(clip, rig, m.clip, m.roots, false);
}

TEST_F(RetargetMaps, AxesOfTheTPose) {
  Rig rig = rig_of(names_, body(&random_));
  for (RigJoint& joint : rig.joints) {
    joint.axes = random_rotation(random_);
    Json& pair = map_["t_pose"]["axes"][joint.name];
    for (int c = 0; c < 2; ++c)
      pair.push_back({joint.axes(0, c), joint.axes(1, c), joint.axes(2, c)});
  }
  const Motion m = motion(random_);
  const Clip clip = retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig", options());
  expect_same_motion(clip, rig, m.clip, m.roots, false);
  map_["t_pose"]["axes"].erase("Bone 7");
  EXPECT_NE(error_of(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), options()).find("Bone 7"),
            std::string::npos);
}

TEST_F(RetargetMaps, EulerAnglesOfTheTPose) {
  Rig rig = rig_of(names_, body(&random_));
  rig.order = "XZY";
  for (RigJoint& joint : rig.joints) {
    joint.axes = random_rotation(random_);
    const RigJoint* parent = rig.parent(joint);
    const Matrix3d above = parent ? parent->axes : Matrix3d(Matrix3d::Identity());
    const Vector3d angles =
        euler_from_matrix(above.transpose() * joint.axes, {0, 2, 1}) * 180 / kPi;
    map_["t_pose"]["euler"][joint.name] = {angles[0], angles[1], angles[2]};
  }
  const Motion m = motion(random_);
  const Bvh bvh = parse_bvh(rig.bvh(m.clip, m.roots), "rig");
  expect_same_motion(retarget_bvh(bvh, "rig", options()), rig, m.clip, m.roots, false);
  map_["t_pose"]["euler"]["Bone 3"] = {1, 2};
  EXPECT_NE(error_of(bvh, options()).find("has 3 rotation channels"), std::string::npos);
}

TEST_F(RetargetMaps, FrameThatIsATPoseAtAnyHeading) {
  Rig rig = rig_of(names_, body(&random_));
  for (RigJoint& joint : rig.joints) joint.axes = random_rotation(random_);
  Motion m = motion(random_);
  m.clip.poses.row(2).setZero();
  m.clip.poses(2, 1) = 2.1;  // heading only
  map_["t_pose"]["frame"] = 2;
  const Bvh bvh = parse_bvh(rig.bvh(m.clip, m.roots), "rig");
  const Clip clip = retarget_bvh(bvh, "rig", options());
  // The heading of a tilted body is known to its hips and shoulders only, so compare limb
  // directions.
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const auto source = rig.positions(joint_world_rotations(m.clip, t), m.roots.row(t).transpose());
    const JointPositions ours = joint_positions(clip, t);
    for (const auto& [joint, child] : kBones)
      EXPECT_LT(((source[static_cast<std::size_t>(child)] - source[static_cast<std::size_t>(joint)])
                     .normalized() -
                 (ours.row(child) - ours.row(joint)).transpose().normalized())
                    .norm(),
                1e-6);
  }
  Clip still = slice(clip, 2, 1);
  EXPECT_NEAR(still.poses(0, 1), 2.1, 0.1);
  still.poses.leftCols<3>().setZero();
  EXPECT_LT(still.poses.cwiseAbs().maxCoeff(), 0.35);  // a T-pose, but for the body's tilted bones
  map_["t_pose"]["frame"] = 4;
  EXPECT_NE(error_of(bvh, options()).find("has 4 frames"), std::string::npos);
}

TEST_F(RetargetMaps, UpFacingAndUnit) {
  Rig rig = rig_of(names_, body(nullptr));
  rig.world = axes(kX, kZ);
  rig.unit = 0.3;
  for (RigJoint& joint : rig.joints) joint.axes = random_rotation(random_);
  for (RigJoint& joint : rig.joints)
    for (int c = 0; c < 2; ++c)
      map_["t_pose"]["axes"][joint.name].push_back(
          {joint.axes(0, c), joint.axes(1, c), joint.axes(2, c)});
  map_["up"] = "+z";
  map_["facing"] = "-y";
  map_["unit"] = 0.3;
  const Motion m = motion(random_);
  const Bvh bvh = parse_bvh(rig.bvh(m.clip, m.roots), "rig");
  expect_same_motion(retarget_bvh(bvh, "rig", options()), rig, m.clip, m.roots, true);
  map_.erase("facing");
  map_.erase("up");
  BvhOptions z_up = options();
  z_up.up = UpAxis::z;
  expect_same_motion(retarget_bvh(bvh, "rig", z_up), rig, m.clip, m.roots, true);
  map_["up"] = "+y";
  map_["facing"] = "-y";
  EXPECT_NE(error_of(bvh, options()).find("same axis"), std::string::npos);
}

TEST_F(RetargetMaps, MistakesAreNamed) {
  map_["joints"]["left_kne"] = "x";
  EXPECT_NE(map_error().find("left_knee"), std::string::npos) << map_error();
  map_["joints"].erase("left_kne");
  map_["joints"].erase("left_knee");
  EXPECT_NE(map_error().find("\"left_knee\": is missing"), std::string::npos) << map_error();
  map_["joints"]["left_knee"] = "Bone 4";
  map_["scale"] = 1;
  EXPECT_NE(map_error().find("scale"), std::string::npos) << map_error();
  map_.erase("scale");
  map_["t_pose"] = {{"axes", {{"Bone 1", {"+x", "-x"}}}}};
  EXPECT_NE(map_error().find("right angles"), std::string::npos) << map_error();
  map_["t_pose"] = {{"axes", {{"Bone 1", {"+x", "up"}}}}};
  EXPECT_NE(map_error().find("directions"), std::string::npos) << map_error();
  map_["t_pose"] = {{"frame", 1}, {"euler", Json::object()}};
  EXPECT_NE(map_error().find("one of"), std::string::npos) << map_error();
  map_["t_pose"] = {{"frame", -1}};
  EXPECT_NE(map_error().find("frame"), std::string::npos) << map_error();
  map_.erase("t_pose");
  map_["unit"] = 0;
  EXPECT_NE(map_error().find("unit"), std::string::npos) << map_error();
  map_.erase("unit");
  EXPECT_EQ(map_error(), "");
  const Motion m = motion(random_, 1);
  map_["joints"]["head"] = "Skull";
  const Rig rig = rig_of(names_, body(nullptr));
  const std::string error = error_of(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), options());
  EXPECT_NE(error.find("has no joint Skull"), std::string::npos) << error;
}

TEST_F(RetargetMaps, ExamplesOfTheManualLoad) {
  const std::string manual = read_file(std::string(MOCAPLM_SOURCE_DIR) + "/docs/bvh-maps.md");
  int examples = 0;
  for (std::size_t at = manual.find("```json\n"); at != manual.npos;
       at = manual.find("```json\n", at + 1)) {
    const std::size_t from = at + 8;
    write_file(path_, manual.substr(from, manual.find("```", from) - from));
    const RetargetMap map = load_map(path_);
    EXPECT_FALSE(map.joints[0].empty());
    ++examples;
  }
  EXPECT_EQ(examples, 2);
}

}  // namespace
}  // namespace mocaplm::retarget_map_test
