// The skeletons of other programs as those programs have them, and a body unlike the mean one.
#pragma once

#include <cctype>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "motion/helpers.h"
#include "motion/skeleton.h"

namespace mocaplm {

// The trees, written down once more from the programs' own files: children in brackets. Where a
// name stands for one of SMPL's joints its number follows.
inline const std::map<std::string, std::string>& trees() {
  static const std::map<std::string, std::string> all = {
      {"mixamo",
       "mixamorig:Hips=0(mixamorig:Spine=3(mixamorig:Spine1=6(mixamorig:Spine2=9("
       "mixamorig:Neck=12(mixamorig:Head=15(mixamorig:HeadTop_End))"
       "mixamorig:LeftShoulder=13(mixamorig:LeftArm=16(mixamorig:LeftForeArm=18("
       "mixamorig:LeftHand=20)))"
       "mixamorig:RightShoulder=14(mixamorig:RightArm=17(mixamorig:RightForeArm=19("
       "mixamorig:RightHand=21))))))"
       "mixamorig:LeftUpLeg=1(mixamorig:LeftLeg=4(mixamorig:LeftFoot=7(mixamorig:LeftToeBase=10("
       "mixamorig:LeftToe_End))))"
       "mixamorig:RightUpLeg=2(mixamorig:RightLeg=5(mixamorig:RightFoot=8("
       "mixamorig:RightToeBase=11(mixamorig:RightToe_End)))))"},
      {"unity",
       "Hips=0(LeftUpperLeg=1(LeftLowerLeg=4(LeftFoot=7(LeftToes=10)))"
       "RightUpperLeg=2(RightLowerLeg=5(RightFoot=8(RightToes=11)))"
       "Spine=3(Chest=6(UpperChest=9(Neck=12(Head=15)"
       "LeftShoulder=13(LeftUpperArm=16(LeftLowerArm=18(LeftHand=20)))"
       "RightShoulder=14(RightUpperArm=17(RightLowerArm=19(RightHand=21)))))))"},
      {"unreal",
       "root(pelvis=0(spine_01=3(spine_02=6(spine_03=9("
       "clavicle_l=13(upperarm_l=16(lowerarm_l=18(hand_l=20)))"
       "clavicle_r=14(upperarm_r=17(lowerarm_r=19(hand_r=21)))neck_01=12(head=15))))"
       "thigh_l=1(calf_l=4(foot_l=7(ball_l=10)))thigh_r=2(calf_r=5(foot_r=8(ball_r=11)))))"},
      {"vrm",
       "hips=0(spine=3(chest=6(upperChest=9(neck=12(head=15)"
       "leftShoulder=13(leftUpperArm=16(leftLowerArm=18(leftHand=20)))"
       "rightShoulder=14(rightUpperArm=17(rightLowerArm=19(rightHand=21))))))"
       "leftUpperLeg=1(leftLowerLeg=4(leftFoot=7(leftToes=10)))"
       "rightUpperLeg=2(rightLowerLeg=5(rightFoot=8(rightToes=11))))"},
      {"rokoko",
       "Root(Hips=0(LeftThigh=1(LeftShin=4(LeftFoot=7(LeftToe=10(LeftToeTip))))"
       "RightThigh=2(RightShin=5(RightFoot=8(RightToe=11(RightToeTip))))"
       "Spine1=3(Spine2=6(Spine3=9(Spine4("
       "LeftShoulder=13(LeftArm=16(LeftForeArm=18(LeftHand=20)))Neck=12(Head=15)"
       "RightShoulder=14(RightArm=17(RightForeArm=19(RightHand=21)))))))))"},
      {"cmu",
       "Hips=0(LHipJoint(LeftUpLeg=1(LeftLeg=4(LeftFoot=7(LeftToeBase=10))))"
       "RHipJoint(RightUpLeg=2(RightLeg=5(RightFoot=8(RightToeBase=11))))"
       "LowerBack=3(Spine=6(Spine1=9(Neck=12(Neck1(Head=15))"
       "LeftShoulder=13(LeftArm=16(LeftForeArm=18(LeftHand=20(LeftFingerBase=22))))"
       "RightShoulder=14(RightArm=17(RightForeArm=19(RightHand=21(RightFingerBase=23))))))))"}};
  return all;
}

struct Named {
  std::string name, parent;
  int smpl;
};

inline std::vector<Named> parsed(const std::string& tree) {
  std::vector<Named> joints;
  std::vector<std::string> above = {""};
  std::string word;
  const auto flush = [&] {
    if (word.empty()) return;
    const std::size_t equals = word.find('=');
    joints.push_back({word.substr(0, equals), above.back(),
                      equals == word.npos ? -1 : std::stoi(word.substr(equals + 1))});
    word.clear();
  };
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const char c = tree[i];
    if (c == '(') {
      flush();
      above.push_back(joints.back().name);
    } else if (c == ')') {
      flush();
      above.pop_back();
    } else {
      // A name follows a number without anything between them.
      if (!word.empty() && word.find('=') != word.npos && !std::isdigit(c)) flush();
      word += c;
    }
  }
  flush();
  return joints;
}

// Unrelated frames of a body of its own: every bone of another length.
inline Clip clip_of_another_body(std::uint64_t seed) {
  Random random(seed);
  Clip clip = random_clip(random, 5, 30);
  clip.trans.col(1).array() += 1;
  BodyShape body;
  body.rest = rest_joints();
  for (int j = 0; j < kJoints; ++j) body.rest->row(j) *= 1.15;
  for (int j = 1; j < kJoints; ++j)
    for (int axis = 0; axis < 3; ++axis) (*body.rest)(j, axis) += random.uniform(-0.01, 0.01);
  clip.body = std::make_shared<const BodyShape>(body);
  return clip;
}

inline Clip clip_of_the_mean_body(std::uint64_t seed) {
  Random random(seed);
  return random_clip(random, 5, 30);
}

}  // namespace mocaplm
