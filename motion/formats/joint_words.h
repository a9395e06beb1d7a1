// What the names of joints say, in the many vocabularies of rigs: "mixamorig:LeftUpLeg",
// "Bip01 L Thigh", "thigh_l", "CC_Base_L_Thigh", "lThigh", "DEF-thigh.L" are all a left thigh.
#pragma once

#include <string>
#include <vector>

namespace mocaplm {

enum class Side { none, left, right };

// Parts of a body as names tell them. Some words mean two things: a "shoulder" is a collar bone
// where an upper arm follows, a "leg" is a shin where a thigh goes before; who reads a whole limb
// decides (recognise.h).
enum class Part {
  unknown,
  helper,  // twist and roll bones, handles, props, clothes, faces: no part of the skeleton
  pelvis,
  spine,
  neck,
  head,
  collar,
  shoulder_or_collar,
  upper_arm,
  arm,  // upper arm or forearm
  forearm,
  hand,
  finger,
  hip,  // thigh, or with no side the pelvis
  thigh,
  leg,  // thigh or shin
  shin,
  foot_or_ankle,
  toe
};

struct JointWord {
  Side side = Side::none;
  Part part = Part::unknown;
  std::string bare;  // the name in small letters without prefix, side and separators: "upleg"
};

// One for each name. What most of the names begin with alike (a namespace, "Bip01 ", "CC_Base_") is
// no part of them.
std::vector<JointWord> joint_words(const std::vector<std::string>& names);

}  // namespace mocaplm
