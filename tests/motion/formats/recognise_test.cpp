#include "motion/formats/recognise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "common/temporary_folder.h"
#include "motion/formats/recognise_guess.h"
#include "motion/formats/retarget_helpers.h"

namespace mocaplm::recognise_test {
namespace {

// What a rig calls SMPL's joints, pelvis and spine first; "@" stands for the side.
struct Vocabulary {
  const char* program;
  std::string left, right;
  std::vector<std::pair<int, std::string>> names;
};

const std::vector<Vocabulary>& vocabularies() {
  static const std::vector<Vocabulary> all = {{"Unity",
                                               "Left",
                                               "Right",
                                               {{0, "Hips"},
                                                {3, "Spine"},
                                                {6, "Chest"},
                                                {9, "UpperChest"},
                                                {12, "Neck"},
                                                {15, "Head"},
                                                {1, "@UpperLeg"},
                                                {4, "@LowerLeg"},
                                                {7, "@Foot"},
                                                {10, "@Toes"},
                                                {13, "@Shoulder"},
                                                {16, "@UpperArm"},
                                                {18, "@LowerArm"},
                                                {20, "@Hand"}}},
                                              {"VRM",
                                               "left",
                                               "right",
                                               {{0, "hips"},
                                                {3, "spine"},
                                                {6, "chest"},
                                                {9, "upperChest"},
                                                {12, "neck"},
                                                {15, "head"},
                                                {1, "@UpperLeg"},
                                                {4, "@LowerLeg"},
                                                {7, "@Foot"},
                                                {10, "@Toes"},
                                                {13, "@Shoulder"},
                                                {16, "@UpperArm"},
                                                {18, "@LowerArm"},
                                                {20, "@Hand"}}},
                                              {"Unreal",
                                               "l",
                                               "r",
                                               {{0, "pelvis"},
                                                {3, "spine_01"},
                                                {6, "spine_02"},
                                                {9, "spine_03"},
                                                {12, "neck_01"},
                                                {15, "head"},
                                                {1, "thigh_@"},
                                                {4, "calf_@"},
                                                {7, "foot_@"},
                                                {10, "ball_@"},
                                                {13, "clavicle_@"},
                                                {16, "upperarm_@"},
                                                {18, "lowerarm_@"},
                                                {20, "hand_@"}}},
                                              {"Biped",
                                               "L",
                                               "R",
                                               {{0, "Bip01 Pelvis"},
                                                {3, "Bip01 Spine"},
                                                {6, "Bip01 Spine1"},
                                                {9, "Bip01 Spine2"},
                                                {12, "Bip01 Neck"},
                                                {15, "Bip01 Head"},
                                                {1, "Bip01 @ Thigh"},
                                                {4, "Bip01 @ Calf"},
                                                {7, "Bip01 @ Foot"},
                                                {10, "Bip01 @ Toe0"},
                                                {13, "Bip01 @ Clavicle"},
                                                {16, "Bip01 @ UpperArm"},
                                                {18, "Bip01 @ Forearm"},
                                                {20, "Bip01 @ Hand"}}},
                                              {"Source",
                                               "L",
                                               "R",
                                               {{0, "ValveBiped.Bip01_Pelvis"},
                                                {3, "ValveBiped.Bip01_Spine"},
                                                {6, "ValveBiped.Bip01_Spine1"},
                                                {9, "ValveBiped.Bip01_Spine4"},
                                                {12, "ValveBiped.Bip01_Neck1"},
                                                {15, "ValveBiped.Bip01_Head1"},
                                                {1, "ValveBiped.Bip01_@_Thigh"},
                                                {4, "ValveBiped.Bip01_@_Calf"},
                                                {7, "ValveBiped.Bip01_@_Foot"},
                                                {10, "ValveBiped.Bip01_@_Toe0"},
                                                {13, "ValveBiped.Bip01_@_Clavicle"},
                                                {16, "ValveBiped.Bip01_@_UpperArm"},
                                                {18, "ValveBiped.Bip01_@_Forearm"},
                                                {20, "ValveBiped.Bip01_@_Hand"}}},
                                              {"rigify",
                                               "L",
                                               "R",
                                               {{0, "spine"},
                                                {3, "spine.001"},
                                                {6, "spine.002"},
                                                {9, "spine.003"},
                                                {12, "spine.004"},
                                                {15, "spine.006"},
                                                {1, "thigh.@"},
                                                {4, "shin.@"},
                                                {7, "foot.@"},
                                                {10, "toe.@"},
                                                {13, "shoulder.@"},
                                                {16, "upper_arm.@"},
                                                {18, "forearm.@"},
                                                {20, "hand.@"}}},
                                              {"deform bones",
                                               "L",
                                               "R",
                                               {{0, "DEF-spine"},
                                                {3, "DEF-spine.001"},
                                                {6, "DEF-spine.002"},
                                                {9, "DEF-spine.003"},
                                                {12, "DEF-neck"},
                                                {15, "DEF-head"},
                                                {1, "DEF-thigh.@"},
                                                {4, "DEF-shin.@"},
                                                {7, "DEF-foot.@"},
                                                {10, "DEF-toe.@"},
                                                {13, "DEF-shoulder.@"},
                                                {16, "DEF-upper_arm.@"},
                                                {18, "DEF-forearm.@"},
                                                {20, "DEF-hand.@"}}},
                                              {"iClone",
                                               "L",
                                               "R",
                                               {{0, "CC_Base_Hip"},
                                                {3, "CC_Base_Waist"},
                                                {6, "CC_Base_Spine01"},
                                                {9, "CC_Base_Spine02"},
                                                {12, "CC_Base_NeckTwist01"},
                                                {15, "CC_Base_Head"},
                                                {1, "CC_Base_@_Thigh"},
                                                {4, "CC_Base_@_Calf"},
                                                {7, "CC_Base_@_Foot"},
                                                {10, "CC_Base_@_ToeBase"},
                                                {13, "CC_Base_@_Clavicle"},
                                                {16, "CC_Base_@_Upperarm"},
                                                {18, "CC_Base_@_Forearm"},
                                                {20, "CC_Base_@_Hand"}}},
                                              {"CMU's .asf",
                                               "l",
                                               "r",
                                               {{0, "root"},
                                                {3, "lowerback"},
                                                {6, "upperback"},
                                                {9, "thorax"},
                                                {12, "lowerneck"},
                                                {15, "head"},
                                                {1, "@femur"},
                                                {4, "@tibia"},
                                                {7, "@foot"},
                                                {10, "@toes"},
                                                {13, "@clavicle"},
                                                {16, "@humerus"},
                                                {18, "@radius"},
                                                {20, "@wrist"}}},
                                              {"Xsens",
                                               "Left",
                                               "Right",
                                               {{0, "Pelvis"},
                                                {3, "L5"},
                                                {6, "T12"},
                                                {9, "T8"},
                                                {12, "Neck"},
                                                {15, "Head"},
                                                {1, "@UpperLeg"},
                                                {4, "@LowerLeg"},
                                                {7, "@Foot"},
                                                {10, "@Toe"},
                                                {13, "@Shoulder"},
                                                {16, "@UpperArm"},
                                                {18, "@ForeArm"},
                                                {20, "@Hand"}}},
                                              {"OptiTrack",
                                               "L",
                                               "R",
                                               {{0, "Hip"},
                                                {6, "Ab"},
                                                {9, "Chest"},
                                                {12, "Neck"},
                                                {15, "Head"},
                                                {1, "@Thigh"},
                                                {4, "@Shin"},
                                                {7, "@Foot"},
                                                {10, "@Toe"},
                                                {13, "@Shoulder"},
                                                {16, "@UArm"},
                                                {18, "@FArm"},
                                                {20, "@Hand"}}},
                                              {"SMPL's .fbx",
                                               "L",
                                               "R",
                                               {{0, "f_avg_Pelvis"},
                                                {3, "f_avg_Spine1"},
                                                {6, "f_avg_Spine2"},
                                                {9, "f_avg_Spine3"},
                                                {12, "f_avg_Neck"},
                                                {15, "f_avg_Head"},
                                                {1, "f_avg_@_Hip"},
                                                {4, "f_avg_@_Knee"},
                                                {7, "f_avg_@_Ankle"},
                                                {10, "f_avg_@_Foot"},
                                                {13, "f_avg_@_Collar"},
                                                {16, "f_avg_@_Shoulder"},
                                                {18, "f_avg_@_Elbow"},
                                                {20, "f_avg_@_Wrist"}}},
                                              {"small letters",
                                               "left",
                                               "right",
                                               {{0, "hips"},
                                                {9, "chest"},
                                                {12, "neck"},
                                                {15, "head"},
                                                {1, "@upleg"},
                                                {4, "@lowleg"},
                                                {7, "@foot"},
                                                {13, "@collar"},
                                                {16, "@uparm"},
                                                {18, "@lowarm"},
                                                {20, "@hand"}}},
                                              {"a namespace",
                                               "l",
                                               "r",
                                               {{0, "hero:hip"},
                                                {6, "hero:abdomen"},
                                                {9, "hero:chest"},
                                                {12, "hero:neck"},
                                                {15, "hero:head"},
                                                {1, "hero:@Hip"},
                                                {4, "hero:@Knee"},
                                                {7, "hero:@Ankle"},
                                                {10, "hero:@Toe"},
                                                {13, "hero:@Clavicle"},
                                                {16, "hero:@Shoulder"},
                                                {18, "hero:@Elbow"},
                                                {20, "hero:@Wrist"}}}};
  return all;
}

Names names_of(const Vocabulary& vocabulary) {
  Names all;
  for (const auto& [joint, pattern] : vocabulary.names) {
    const std::size_t at = pattern.find('@');
    if (at == pattern.npos) {
      all.push_back({joint, pattern});
      continue;
    }
    for (const bool left : {true, false})
      all.push_back({left ? joint : mirrored_joints()[static_cast<std::size_t>(joint)],
                     pattern.substr(0, at) + (left ? vocabulary.left : vocabulary.right) +
                         pattern.substr(at + 1)});
  }
  return all;
}

// Every joint with its place in SMPL.
void expect_recognised(const Rig& rig, const std::string& what, const Names& names,
                       const Motion& m) {
  SCOPED_TRACE(what);
  const Bvh bvh = parse_bvh(rig.bvh(m.clip, m.roots), what);
  const Recognised found = recognise_body(bvh);
  EXPECT_EQ(found.doubt, "");
  for (const auto& [joint, name] : names) {
    const int index = found.joints[static_cast<std::size_t>(joint)];
    EXPECT_EQ(index < 0 ? "none" : bvh.joints[static_cast<std::size_t>(index)].name, name)
        << joint_names()[static_cast<std::size_t>(joint)];
  }
}

TEST(Recognise, VocabulariesOfManyPrograms) {
  Random random(41);
  for (const Vocabulary& vocabulary : vocabularies()) {
    const Names names = names_of(vocabulary);
    const Motion m = motion(random);
    const Rig rig = rig_of(names, body(&random));
    expect_recognised(rig, vocabulary.program, names, m);
    BvhOptions options;
    options.keep_path = true;
    const Clip clip = retarget_bvh(parse_bvh(rig.bvh(m.clip, m.roots), "rig"), "rig", options);
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const auto source =
          rig.positions(joint_world_rotations(m.clip, t), m.roots.row(t).transpose());
      const auto at = [&](int role) {
        for (std::size_t i = 0; i < rig.joints.size(); ++i)
          if (rig.joints[i].role == role) return source[i];
        return Vector3d(Vector3d::Zero());
      };
      const JointPositions ours = joint_positions(clip, t);
      for (const auto& [joint, child] : kBones)
        EXPECT_LT(((at(child) - at(joint)).normalized() -
                   (ours.row(child) - ours.row(joint)).transpose().normalized())
                      .norm(),
                  1e-5)
            << vocabulary.program << " " << joint;
    }
  }
}

// Twist bones in line and beside, fingers, eyes, a prop: none of them is a limb.
TEST(Recognise, HelpersAreNoLimbs) {
  Random random(42);
  const Names names = names_of(vocabularies()[2]);
  Rig rig = rig_of(names, body(nullptr));
  const auto add = [&](const std::string& name, const std::string& parent, int role,
                       const Vector3d& offset) {
    const auto above = rig.joints[static_cast<std::size_t>(rig.index(parent))];
    rig.joints.push_back({name, parent, role, above.position + offset});
  };
  for (const bool left : {true, false}) {
    const std::string s = left ? "l" : "r";
    const double x = left ? 1 : -1;
    add("thigh_twist_01_" + s, "thigh_" + s, left ? 1 : 2, {0, -0.2, 0});
    add("ik_foot_" + s, "foot_" + s, left ? 7 : 8, {0, 0, 0});
    add("eye_" + s, "head", 15, {0.03 * x, 0.1, 0.08});
    for (const char* finger : {"thumb", "index", "middle"})
      for (int k = 1; k <= 3; ++k)
        add(finger + std::string("_0") + std::to_string(k) + "_" + s,
            k == 1 ? "hand_" + s : finger + std::string("_0") + std::to_string(k - 1) + "_" + s,
            left ? 20 : 21, {0.04 * x, 0, finger[0] == 't' ? 0.03 : 0});
  }
  add("weapon", "hand_r", 21, {0, 0, 1.2});
  expect_recognised(rig, "helpers", names, motion(random, 1));
}

// Nothing but the tree, the lengths and the toes.
TEST(Recognise, NamesThatSayNothing) {
  Random random(43);
  Names names;
  for (const int joint :
       {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21})
    names.push_back({joint, "n" + std::to_string(100 + (joint * 7) % 23)});
  expect_recognised(rig_of(names, body(nullptr)), "numbers", names, motion(random, 1));
}

// A limb whose names say nothing among others that do.
TEST(Recognise, OneLimbWithoutNames) {
  Random random(46);
  for (const std::vector<int>& limb :
       {std::vector<int>{1, 4, 7, 10}, std::vector<int>{14, 17, 19, 21}}) {
    Names names = names_of(vocabularies()[2]);
    for (auto& [joint, name] : names)
      if (std::count(limb.begin(), limb.end(), joint) > 0) name = "n" + std::to_string(joint);
    expect_recognised(rig_of(names, body(nullptr)), "one limb", names, motion(random, 1));
  }
}

// The best guess of a figure that lacks an arm says what the names do.
TEST(Recognise, GuessesByNames) {
  std::array<int, kJoints> joints;
  joints.fill(-1);
  guess_by_words(joint_words({"Hips", "Spine", "Spine1", "LeftUpLeg", "LeftLeg", "RightUpLeg",
                              "RightLeg", "RightFoot", "Sword", "RightArm", "RightForeArm"}),
                 joints);
  const std::map<int, int> truth = {{0, 0}, {3, 1}, {6, 2}, {1, 3},  {4, 4},
                                    {2, 5}, {5, 6}, {8, 7}, {17, 9}, {19, 10}};
  for (int j = 0; j < kJoints; ++j)
    EXPECT_EQ(joints[static_cast<std::size_t>(j)], truth.count(j) > 0 ? truth.at(j) : -1) << j;
}

TEST(Recognise, AnimalsAreDoubted) {
  Random random(44);
  const Motion m = motion(random, 1);
  // Four legs by their names.
  Names dog = names_of(vocabularies()[2]);
  for (auto& [joint, name] : dog) {
    const std::string side = name.substr(name.size() - 2);
    if (joint == 16 || joint == 17) name = "frontleg_upper" + side;
    if (joint == 18 || joint == 19) name = "frontleg_lower" + side;
    if (joint == 20 || joint == 21) name = "frontpaw" + side;
  }
  const Rig rig = rig_of(dog, body(nullptr));
  EXPECT_NE(recognise_body(parse_bvh(rig.bvh(m.clip, m.roots), "dog")).doubt, "");
}

TEST(Recognise, SpinesOfOneToSixJoints) {
  std::array<int, kJoints> joints;
  assign_spine({5}, {0.3}, joints);
  EXPECT_EQ(joints[9], 5);
  EXPECT_EQ(joints[6], -1);
  assign_spine({5, 6}, {0.1, 0.3}, joints);
  EXPECT_EQ(joints[6], 5);
  EXPECT_EQ(joints[3], -1);
  assign_spine({5, 6, 7, 8, 9, 10}, {0.1, 0.15, 0.2, 0.29, 0.4, 0.5}, joints);
  EXPECT_EQ(joints[3], 5);
  EXPECT_EQ(joints[6], 8);
  EXPECT_EQ(joints[9], 10);
}

// A map that is written is one that can be given back.
TEST(Recognise, TheMapThatIsWrittenReadsTheFile) {
  Random random(45);
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "map.json").string();
  const Rig rig = rig_of(names_of(vocabularies()[3]), body(&random));
  const Motion m = motion(random);
  const Bvh bvh = parse_bvh(rig.bvh(m.clip, m.roots), "rig");
  BvhOptions options;
  options.write_map = path;
  const Clip clip = retarget_bvh(bvh, "rig", options);
  BvhOptions given;
  given.map_file = path;
  const Clip again = retarget_bvh(bvh, "rig", given);
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    EXPECT_LT((joint_positions(clip, t) - joint_positions(again, t)).norm(), 1e-9);
}

}  // namespace
}  // namespace mocaplm::recognise_test
