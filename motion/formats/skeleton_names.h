// What the programs call the joints of their skeletons (motion/formats/skeletons.h).
#pragma once

#include <string>

#include "motion/formats/skeletons.h"

namespace mocaplm {

// "*" stands for the side; "" for a joint that the scheme does not have.
struct SkeletonNames {
  enum class NeckAt { first, between_the_arms, last };

  std::string prefix;  // of every name
  std::string left = "Left", right = "Right";
  std::string root, pelvis = "Hips";
  std::string spine[4];  // the fourth lies between SMPL's spine3 and its neck
  std::string neck = "Neck", neck1, head = "Head", head_end;
  std::string collar = "*Shoulder", shoulder, elbow, wrist = "*Hand", hand;
  std::string left_hip_joint, right_hip_joint;
  std::string hip, knee, ankle = "*Foot", foot, toe_end;
  bool legs_first = false;         // in the hierarchy, before the spine
  NeckAt neck_at = NeckAt::first;  // in the hierarchy, among the arms
  double arms_down_degrees = 0;    // in the rest pose, below the horizontal
};

// For all but OutScheme::smpl.
const SkeletonNames& skeleton_names(OutScheme scheme);

}  // namespace mocaplm
