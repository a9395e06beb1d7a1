#include "motion/formats/retarget.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/error.h"
#include "common/files.h"
#include "common/json.h"
#include "common/random.h"
#include "common/text.h"
#include "motion/formats/rig.h"
#include "motion/helpers.h"

namespace mocaplm {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();
// Elbows, shoulders, knees, hips: (joint, child).
const std::vector<std::pair<int, int>> kBones = {{16, 18}, {18, 20}, {17, 19}, {19, 21},
                                                 {1, 4},   {4, 7},   {2, 5},   {5, 8}};

Vector3d rest(int joint) {
  return rest_joints().row(joint).transpose();
}

// SMPL's rest joints, or another body: bones longer or shorter and a little tilted.
std::vector<Vector3d> body(Random* random) {
  std::vector<Vector3d> joints;
  for (int j = 0; j < kJoints; ++j) {
    const int parent = joint_parents()[static_cast<std::size_t>(j)];
    if (parent < 0 || !random) {
      joints.push_back(rest(j));
      continue;
    }
    Vector3d bone = rest(j) - rest(parent);
    bone = random->uniform(0.8, 1.2) * (bone + 0.1 * bone.norm() * random_direction(*random));
    joints.push_back(joints[static_cast<std::size_t>(parent)] + bone);
  }
  return joints;
}

using Names = std::vector<std::pair<int, std::string>>;  // SMPL joint -> name in the file

// A rig of the named joints; each hangs on its nearest named ancestor.
Rig rig_of(const Names& names, const std::vector<Vector3d>& positions) {
  Rig rig;
  for (int j = 0; j < kJoints; ++j)
    for (const auto& [joint, name] : names) {
      if (joint != j) continue;
      std::string parent;
      for (int p = joint_parents()[static_cast<std::size_t>(j)]; p >= 0 && parent.empty();
           p = joint_parents()[static_cast<std::size_t>(p)])
        for (const auto& [other, other_name] : names)
          if (other == p) parent = other_name;
      rig.joints.push_back({name, parent, j, positions[static_cast<std::size_t>(j)]});
    }
  return rig;
}

// Puts a joint that turns with its parent between `child` and its parent: a buttock, a lower back.
void insert_between(Rig& rig, const std::string& name, const std::string& child) {
  const auto at = static_cast<std::size_t>(rig.index(child));
  RigJoint joint = rig.joints[at];
  const RigJoint* parent = rig.parent(joint);
  joint.role = parent->role;
  joint.position = 0.3 * parent->position + 0.7 * joint.position;
  joint.name = name;
  rig.joints[at].parent = name;
  rig.joints.insert(rig.joints.begin() + static_cast<std::ptrdiff_t>(at), joint);
}

// "S" becomes the side.
Names names(const std::vector<std::pair<int, std::string>>& middle,
            const std::vector<std::pair<int, std::string>>& sides, const std::string& left,
            const std::string& right) {
  Names all = middle;
  for (const auto& [joint, pattern] : sides)
    for (const bool is_left : {true, false}) {
      const std::size_t at = pattern.find('S');
      all.push_back({is_left ? joint : mirrored_joints()[static_cast<std::size_t>(joint)],
                     pattern.substr(0, at) + (is_left ? left : right) + pattern.substr(at + 1)});
    }
  return all;
}

Names daz_names() {
  return names({{0, "hip"}, {6, "abdomen"}, {9, "chest"}, {12, "neck"}, {15, "head"}},
               {{1, "SThigh"},
                {4, "SShin"},
                {7, "SFoot"},
                {13, "SCollar"},
                {16, "SShldr"},
                {18, "SForeArm"},
                {20, "SHand"}},
               "l", "r");
}
Names bandai_names() {
  Names all = names({{0, "Hips"}, {6, "Spine"}, {9, "Chest"}, {12, "Neck"}, {15, "Head"}},
                    {{1, "UpperLeg_S"},
                     {4, "LowerLeg_S"},
                     {7, "Foot_S"},
                     {10, "Toes_S"},
                     {13, "@houlder_S"},
                     {16, "UpperArm_S"},
                     {18, "LowerArm_S"},
                     {20, "Hand_S"}},
                    "L", "R");
  for (auto& name : all) std::replace(name.second.begin(), name.second.end(), '@', 'S');
  return all;
}
Names mixamo_names(const std::string& prefix, const std::string& toes) {
  Names all =
      names({{0, "Hips"}, {3, "Spine"}, {6, "Spine1"}, {9, "Spine2"}, {12, "Neck"}, {15, "Head"}},
            {{1, "SUpLeg"},
             {4, "SLeg"},
             {7, "SFoot"},
             {10, "S" + toes},
             {13, "SShoulder"},
             {16, "SArm"},
             {18, "SForeArm"},
             {20, "SHand"}},
            "Left", "Right");
  for (auto& name : all) name.second = prefix + name.second;
  return all;
}
Names without(Names all, int joint) {
  for (auto at = all.begin(); at != all.end();) at = at->first == joint ? all.erase(at) : at + 1;
  return all;
}

Rig daz(const std::vector<Vector3d>& positions) {
  Rig rig = rig_of(daz_names(), positions);
  insert_between(rig, "lButtock", "lThigh");
  insert_between(rig, "rButtock", "rThigh");
  return rig;
}
// The table of data/README.md, item 5.
Rig bandai(const std::vector<Vector3d>& positions) {
  Rig rig = rig_of(bandai_names(), positions);
  const double a = 39.59 * M_PI / 180, b = 23.01 * M_PI / 180;
  const Vector3d f(0, -std::sin(a), std::cos(a)), t(0, -std::sin(b), std::cos(b));
  for (RigJoint& joint : rig.joints) {
    const std::string& n = joint.name;
    const bool left = n.back() == 'L';
    if (n == "Hips")
      joint.axes = axes(kY, -kX);
    else if (n.find('_') == n.npos)
      joint.axes = axes(kY, kZ);
    else if (n.find("Leg") != n.npos)
      joint.axes = left ? axes(-kY, kX) : axes(kY, kX);
    else if (n.find("Foot") != n.npos)
      joint.axes = axes(left ? f : -f, kX);
    else if (n.find("Toes") != n.npos)
      joint.axes = axes(left ? t : -t, kX);
    else
      joint.axes = axes(kX, left ? kY : -kY);
  }
  rig.joints.insert(rig.joints.begin(), {"joint_Root", "", 0, rest(0)});
  rig.joints[1].parent = "joint_Root";
  return rig;
}
// Every bone along its parent's +x; feet and arms as in LAFAN1.
Rig lafan(const std::vector<Vector3d>& positions) {
  Rig rig = rig_of(mixamo_names("", "Toe"), positions);
  rig.order = "ZYX";
  for (RigJoint& joint : rig.joints) {
    const std::string& n = joint.name;
    const bool left = n[0] == 'L', side = left || n[0] == 'R';
    const double down = (n.find("Toe") != n.npos ? 4.5 : 25.5) * M_PI / 180;
    if (!side)
      joint.axes = axes(kY, kZ);
    else if (n.find("Leg") != n.npos)
      joint.axes = axes(-kY, kZ);
    else if (n.find("Foot") != n.npos || n.find("Toe") != n.npos)
      joint.axes = axes({0, -std::sin(down), std::cos(down)}, {0, std::cos(down), std::sin(down)});
    else
      joint.axes = axes(left ? kX : Vector3d(-kX), -kZ);
  }
  return rig;
}
Rig mixamo(const std::vector<Vector3d>& positions) {
  return rig_of(mixamo_names("mixamorig:", "ToeBase"), positions);
}
Rig mixamo_with_prefix(const std::vector<Vector3d>& positions) {
  return rig_of(mixamo_names("Model_", "ToeBase"), positions);
}
Rig motionbuilder(const std::vector<Vector3d>& positions) {
  Names all = mixamo_names("", "ToeBase");
  for (auto& [joint, name] : all)
    joint = name == "Spine" ? 6 : name == "Spine1" ? 9 : name == "Spine2" ? -1 : joint;
  return rig_of(without(all, -1), positions);
}
Rig cmu(const std::vector<Vector3d>& positions) {
  Names all = mixamo_names("", "ToeBase");
  for (auto& [joint, name] : all)
    name = name == "Spine"    ? "LowerBack"
           : name == "Spine1" ? "Spine"
           : name == "Spine2" ? "Spine1"
                              : name;
  Rig rig = rig_of(all, positions);
  insert_between(rig, "LHipJoint", "LeftUpLeg");
  insert_between(rig, "RHipJoint", "RightUpLeg");
  rig.unit = 0.0254 / 0.45;
  return rig;
}
Rig classic(const std::vector<Vector3d>& positions) {
  return rig_of(names({{0, "Hips"}, {9, "Chest"}, {12, "Neck"}, {15, "Head"}},
                      {{1, "SHip"},
                       {4, "SKnee"},
                       {7, "SAnkle"},
                       {10, "SToe"},
                       {13, "SCollar"},
                       {16, "SShoulder"},
                       {18, "SElbow"},
                       {20, "SWrist"}},
                      "Left", "Right"),
                positions);
}
Rig smpl(const std::vector<Vector3d>& positions) {
  Names all;
  for (int j = 0; j < kJoints; ++j) all.push_back({j, joint_names()[static_cast<std::size_t>(j)]});
  return rig_of(all, positions);
}

struct Scheme {
  const char* name;
  Rig (*rig)(const std::vector<Vector3d>&);
};
const std::vector<Scheme> kSchemes = {
    {"cmu-daz", daz},   {"bandai-namco", bandai},       {"lafan", lafan},
    {"mixamo", mixamo}, {"mixamo", mixamo_with_prefix}, {"motionbuilder", motionbuilder},
    {"cmu", cmu},       {"classic", classic},           {"smpl", smpl}};

bool limb(int role) {
  for (const auto& bone : kBones)
    if (bone.first == role) return true;
  return role >= 20;  // the wrist is turned by the hand's direction, which differs
}

// Demands that `clip` shows the motion that `rig` wrote: rotations of joints that are not limbs,
// limb directions and the hips' place. With `exact` (SMPL's own body) also the limbs' rotations.
void expect_same_motion(const Clip& clip, const Rig& rig, const Clip& truth,
                        const Translations& roots, bool exact) {
  ASSERT_EQ(clip.frames(), truth.frames());
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const auto turned = joint_world_rotations(truth, t), ours = joint_world_rotations(clip, t);
    for (const RigJoint& joint : rig.joints) {
      const auto role = static_cast<std::size_t>(joint.role);
      if (exact ? joint.role >= 20 : limb(joint.role)) continue;
      EXPECT_LT((ours[role] - turned[role]).norm(), 1e-6) << joint.name << " frame " << t;
    }
    const auto source = rig.positions(turned, roots.row(t).transpose());
    const auto at = [&](int role) {  // the last joint of a role is the one with its name
      Vector3d found = Vector3d::Zero();
      for (std::size_t i = 0; i < rig.joints.size(); ++i)
        if (rig.joints[i].role == role) found = source[i];
      return found;
    };
    const JointPositions positions = joint_positions(clip, t);
    for (const auto& [joint, child] : kBones) {
      const Vector3d theirs = (at(child) - at(joint)).normalized();
      const Vector3d bone = (positions.row(child) - positions.row(joint)).transpose().normalized();
      EXPECT_LT((theirs - bone).norm(), 1e-6)
          << joint_names()[static_cast<std::size_t>(joint)] << " frame " << t;
    }
    const Vector3d hips = 0.5 * (positions.row(1) + positions.row(2)).transpose();
    EXPECT_LT((hips - 0.5 * (at(1) + at(2))).norm(), 1e-6) << "frame " << t;
  }
}

struct Motion {
  Clip clip;
  Translations roots;
};
Motion motion(Random& random, Eigen::Index frames = 4) {
  Motion m{random_clip(random, frames, 30, 1.0), {}};
  m.roots = m.clip.trans.rowwise() + rest_joints().row(0);
  return m;
}

TEST(Retarget, EverySchemeGivesBackItsPose) {
  Random random(21);
  for (const Scheme& scheme : kSchemes)
    for (const bool exact : {true, false}) {
      SCOPED_TRACE(std::string(scheme.name) + (exact ? " SMPL's body" : " another body"));
      const bool smpl_rotations = std::string(scheme.name) == "smpl";
      if (smpl_rotations && !exact) continue;  // keeps SMPL's rotations, whatever the body
      const Rig rig = scheme.rig(body(exact ? nullptr : &random));
      const Motion m = motion(random);
      RetargetReport report;
      const Clip clip =
          retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "a/rig.bvh", {}, &report);
      EXPECT_EQ(report.scheme, scheme.name);
      EXPECT_NEAR(report.unit, rig.unit, 1e-12);
      EXPECT_EQ(clip.name, "rig");
      EXPECT_EQ(clip.fps, 30);
      EXPECT_EQ(report.limbs.size(), 8u);
      EXPECT_LT(report.mean_degrees, 1e-4);
      EXPECT_LE(report.mean_degrees, report.max_degrees);
      expect_same_motion(clip, rig, m.clip, m.roots, exact);
    }
}

TEST(Retarget, ReportMeasuresWhatIsWrong) {
  Random random(22);
  const Rig rig = daz(body(&random));
  const Motion m = motion(random);
  const Bvh bvh = parse_bvh(rig.bvh(m.clip, m.roots), "rig");
  RetargetMap map = detect_map(bvh, "rig");
  map.align = false;
  RetargetReport report;
  retarget_bvh(bvh, map, "rig", {}, &report);
  EXPECT_GT(report.mean_degrees, 0.5);  // the body's bones are tilted by up to 6 degrees
  EXPECT_LT(report.max_degrees, 15);
}

TEST(Retarget, MissingSpineJointsShareTheTurn) {
  Random random(23);
  const Rig rig = daz(body(nullptr));  // without spine1
  const Motion m = motion(random, 1);
  const Clip clip = retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig");
  EXPECT_LT((clip.poses.row(0).segment<3>(9) - clip.poses.row(0).segment<3>(18)).norm(), 1e-6);
  EXPECT_EQ(clip.poses.row(0).segment<6>(30).norm(), 0);  // toes
  EXPECT_EQ(clip.poses.row(0).segment<6>(66).norm(), 0);  // hands
}

// CMU's original zero pose: legs 20 degrees apart and the feet tilted with them.
TEST(Retarget, FeetOfASpreadZeroPoseStandFlat) {
  Random random(32);
  Rig rig = cmu(body(nullptr));
  for (RigJoint& joint : rig.joints) {
    const std::string& n = joint.name;
    if (n.find("Leg") != n.npos || n.find("Foot") != n.npos || n.find("Toe") != n.npos)
      joint.axes = matrix_from_axis_angle((n[0] == 'L' ? -1 : 1) * 20 * M_PI / 180 * kZ);
  }
  const Motion m = motion(random);
  const Clip clip = retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig");
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const auto turned = joint_world_rotations(m.clip, t), ours = joint_world_rotations(clip, t);
    for (const std::size_t j : {7, 8, 10, 11})  // SMPL's own shins are 2 degrees off the vertical
      EXPECT_LT(geodesic_angle(Eigen::Quaterniond(turned[j]), Eigen::Quaterniond(ours[j])), 0.05);
  }
}

TEST(Retarget, HandDirectionTurnsTheWrist) {
  Random random(24);
  Rig rig = daz(body(&random));
  const auto wrist = rig.joints[static_cast<std::size_t>(rig.index("lHand"))];
  rig.joints.push_back({"lMid1", "lHand", 20, wrist.position + Vector3d(0.08, 0.02, 0.03)});
  const Motion m = motion(random, 1);
  const Clip clip = retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig");
  const Vector3d theirs = joint_world_rotations(m.clip, 0)[20] * Vector3d(0.08, 0.02, 0.03);
  const JointPositions positions = joint_positions(clip, 0);
  EXPECT_LT((theirs.normalized() - (positions.row(22) - positions.row(20)).transpose().normalized())
                .norm(),
            1e-6);
}

TEST(Retarget, RotationVectorsContinueInTime) {
  // One full turn about Y: the vector grows to pi, where the sign must flip, and nowhere else.
  Random random(25);
  Motion m = motion(random, 1);
  m.clip.poses.setZero(73, 72);
  m.roots.setZero(73, 3);
  for (Eigen::Index t = 0; t < 73; ++t)
    m.clip.poses(t, 1) = 2 * M_PI * static_cast<double>(t) / 72 + 1e-3;
  const Clip clip =
      retarget_bvh(parse_bvh(mixamo(body(nullptr)).bvh(m.clip, m.roots), "rig"), "rig");
  int jumps = 0;
  for (Eigen::Index t = 1; t < 73; ++t)
    jumps += (clip.poses.row(t) - clip.poses.row(t - 1)).cwiseAbs().maxCoeff() > 0.2;
  EXPECT_EQ(jumps, 1);
  EXPECT_LE(clip.poses.cwiseAbs().maxCoeff(), M_PI + 1e-9);
}

TEST(Retarget, UnitsAndRate) {
  Random random(26);
  const Motion m = motion(random, 2);
  Rig rig = mixamo(body(nullptr));
  for (const double unit : {1.0, 0.01, 0.001}) {
    rig.unit = unit;
    RetargetReport report;
    const Clip clip = retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig", {}, &report);
    EXPECT_EQ(report.unit, unit);
    EXPECT_NEAR(report.height, 1.7, 0.02);
    EXPECT_LT((clip.trans - m.clip.trans).norm(), 1e-6);
  }
  BvhOptions options;
  options.unit = 0.0005;
  options.fps = 60;
  const Bvh bvh = parse_bvh(rig.bvh(m.clip, m.roots), "rig");
  RetargetReport report;
  EXPECT_EQ(retarget_bvh(bvh, "rig", options, &report).fps, 60);
  EXPECT_NEAR(report.height, 0.85, 0.01);
  options.unit = 1;
  EXPECT_THROW(retarget_bvh(bvh, "rig", options), DataError);  // 1.7 km
  options.unit = -1;
  EXPECT_THROW(retarget_bvh(bvh, "rig", options), UsageError);
  options = {};
  options.fps = 0;
  EXPECT_THROW(retarget_bvh(bvh, "rig", options), UsageError);
}

// Z up, facing -Y, as Blender and 3ds Max have it: found from the zero pose.
TEST(Retarget, OtherWorldsAreTurnedIntoOurs) {
  Random random(27);
  const Motion m = motion(random);
  const std::vector<Matrix3d> worlds = {axes(kX, kZ), axes(-kX, kY), axes(-kZ, kY), axes(kY, kZ),
                                        axes(-kX, kZ)};
  for (const Matrix3d& world : worlds) {
    Rig rig = mixamo(body(nullptr));
    rig.world = world;
    for (RigJoint& joint : rig.joints) joint.axes = world.transpose();
    const Clip clip = retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig");
    expect_same_motion(clip, rig, m.clip, m.roots, true);
  }
}

std::string error_of(const Bvh& bvh, const BvhOptions& options = {}) {
  try {
    retarget_bvh(bvh, "walk.bvh", options);
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

TEST(Retarget, UnknownSkeletonIsRefusedWithItsJoints) {
  Random random(28);
  const Motion m = motion(random, 1);
  Rig rig = mixamo(body(nullptr));
  std::string text = rig.bvh(m.clip, m.roots);
  for (std::size_t at = text.find("LeftLeg"); at != text.npos; at = text.find("LeftLeg"))
    text.replace(at, 7, "LShank_");
  const std::string error = error_of(parse_bvh(text, "walk.bvh"));
  EXPECT_NE(error.find("walk.bvh: the joints are named by no scheme"), std::string::npos) << error;
  EXPECT_NE(error.find("without a match for left_knee"), std::string::npos) << error;
  EXPECT_NE(error.find("mixamorig:LShank_"), std::string::npos) << error;
  EXPECT_NE(error.find("docs/bvh-maps.md"), std::string::npos) << error;
}

TEST(Retarget, KnownNamesWithAnUnknownZeroPoseAreRefused) {
  Random random(29);
  const Motion m = motion(random, 1);
  Rig rig = mixamo(body(nullptr));
  const Matrix3d tilt = matrix_from_axis_angle(M_PI / 4 * kX);
  for (RigJoint& joint : rig.joints) joint.axes = tilt;
  const std::string error = error_of(parse_bvh(rig.bvh(m.clip, m.roots), "walk.bvh"));
  EXPECT_NE(error.find("does not stand upright"), std::string::npos) << error;
}

TEST(Retarget, DamagedFilesAreRefusedOrSound) {
  Random random(30);
  const Motion m = motion(random, 2);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text =
        kSchemes[random.below(kSchemes.size())].rig(body(nullptr)).bvh(m.clip, m.roots);
    for (std::uint64_t k = 1 + random.below(3); k > 0; --k) {
      const std::size_t at = random.below(text.size());
      const char* const marks = "0123456789.-+eE{} \n";
      if (random.below(2))
        text[at] = marks[random.below(19)];
      else
        text.erase(at, 1 + random.below(40));
    }
    try {
      check_clip(retarget_bvh(parse_bvh(text, "damaged"), "damaged"), "damaged");
    } catch (const DataError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

// Map files.

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
        euler_from_matrix(above.transpose() * joint.axes, {0, 2, 1}) * 180 / M_PI;
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
}  // namespace mocaplm
