#include "motion/formats/retarget.h"

#include <gtest/gtest.h>

#include "common/angles.h"
#include "motion/formats/retarget_helpers.h"

namespace mocaplm::retarget_test {
namespace {

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
  const double a = 39.59 * kPi / 180, b = 23.01 * kPi / 180;
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
    const double down = (n.find("Toe") != n.npos ? 4.5 : 25.5) * kPi / 180;
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
    {"cmu-daz", daz},   {"bandai-namco", bandai},       {"mixamo", lafan},
    {"mixamo", mixamo}, {"mixamo", mixamo_with_prefix}, {"motionbuilder", motionbuilder},
    {"cmu", cmu},       {"classic", classic},           {"smpl", smpl}};

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
      BvhOptions options;
      options.keep_path = !exact;
      const Clip clip =
          retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "a/rig.bvh", options, &report);
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
      joint.axes = matrix_from_axis_angle((n[0] == 'L' ? -1 : 1) * 20 * kPi / 180 * kZ);
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
    m.clip.poses(t, 1) = 2 * kPi * static_cast<double>(t) / 72 + 1e-3;
  const Clip clip =
      retarget_bvh(parse_bvh(mixamo(body(nullptr)).bvh(m.clip, m.roots), "rig"), "rig");
  int jumps = 0;
  for (Eigen::Index t = 1; t < 73; ++t)
    jumps += (clip.poses.row(t) - clip.poses.row(t - 1)).cwiseAbs().maxCoeff() > 0.2;
  EXPECT_EQ(jumps, 1);
  EXPECT_LE(clip.poses.cwiseAbs().maxCoeff(), kPi + 1e-9);
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

TEST(Retarget, UnknownSkeletonIsRefusedWithItsJoints) {
  Random random(28);
  const Motion m = motion(random, 1);
  Rig rig = mixamo(body(nullptr));
  // A figure with one arm is none.
  for (const char* joint : {"LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"})
    rig.joints.erase(rig.joints.begin() + rig.index(std::string("mixamorig:") + joint));
  const std::string error = error_of(parse_bvh(rig.bvh(m.clip, m.roots), "walk.bvh"));
  EXPECT_NE(error.find("walk.bvh: is no figure that is recognised for certain"), std::string::npos)
      << error;
  EXPECT_NE(error.find("--write-map"), std::string::npos) << error;
  EXPECT_NE(error.find("mixamorig:RightForeArm"), std::string::npos) << error;
}

// Every joint's axes lie askew in the T-pose: the bones tell how.
TEST(Retarget, AxesAskewAreFoundFromTheBones) {
  Random random(29);
  const Motion m = motion(random);
  Rig rig = mixamo(body(nullptr));
  const Matrix3d tilt = matrix_from_axis_angle(kPi / 4 * kX);
  for (RigJoint& joint : rig.joints) joint.axes = tilt;
  RetargetReport report;
  const Clip clip =
      retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "walk.bvh", {}, &report);
  EXPECT_EQ(report.rest_pose, "the directions of its bones");
  expect_same_motion(clip, rig, m.clip, m.roots, true);
}

// Bones along their joints' own x, legs turned half about in the zero pose: how thighs and upper
// arms are turned about themselves shows in the way that knees and elbows bend.
TEST(Retarget, KneesAndElbowsTellHowLimbsAreTurned) {
  Random random(33);
  Rig rig = lafan(body(nullptr));
  for (RigJoint& joint : rig.joints) {
    std::string& name = joint.name;
    if (name == "LeftUpLeg" || name == "RightUpLeg") name.insert(name.size() - 3, "per");
  }
  for (RigJoint& joint : rig.joints)
    if (joint.parent == "LeftUpLeg" || joint.parent == "RightUpLeg")
      joint.parent.insert(joint.parent.size() - 3, "per");
  Motion m = motion(random, 40);
  m.clip.poses *= 0.2;
  for (Eigen::Index t = 0; t < 40; ++t) {
    for (const int knee : {4, 5})
      m.clip.poses.row(t).segment<3>(3 * knee) << random.uniform(0.4, 1.6), 0, 0;
    m.clip.poses.row(t).segment<3>(3 * 18) << 0, -random.uniform(0.4, 1.6), 0;
    m.clip.poses.row(t).segment<3>(3 * 19) << 0, random.uniform(0.4, 1.6), 0;
  }
  RetargetReport report;
  const Clip clip =
      retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "walk.bvh", {}, &report);
  EXPECT_EQ(report.scheme, "recognised");
  EXPECT_EQ(report.rest_pose, "the directions of its bones");
  for (Eigen::Index t = 0; t < 40; ++t) {
    const auto turned = joint_world_rotations(m.clip, t), ours = joint_world_rotations(clip, t);
    for (const std::size_t j : {1, 2, 4, 5, 7, 8, 16, 17, 18, 19})
      EXPECT_LT(geodesic_angle(Eigen::Quaterniond(turned[j]), Eigen::Quaterniond(ours[j])), 0.5)
          << joint_names()[j] << " frame " << t;
  }
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

}  // namespace
}  // namespace mocaplm::retarget_test
