// The skeletons of the programs that people animate with, as a clip is written for them: joint
// names, hierarchy and rest pose are the program's, the bones are as long as those of the clip's
// body, and every joint of SMPL's that has a counterpart lies where the clip has it.
//
//   smpl     SMPL's own 24 joints and its rest pose
//   mixamo   Adobe Mixamo, the 25 joints of its skeleton without fingers ("mixamorig:Hips"); T-pose
//   unity    the names of Unity's humanoid avatar ("LeftUpperArm"); T-pose
//   unreal   Epic's Mannequin of Unreal Engine 4 ("upperarm_l"), with its "root" on the ground;
//            A-pose, the arms 45 degrees below the horizontal
//   vrm      the humanoid bones of VRM 1.0 ("leftUpperArm"); T-pose
//   rokoko   Rokoko Studio's "Newton" ("Spine1" to "Spine4", "LeftThigh", "LeftShin"); T-pose
//   cmu      the CMU database's own names as MotionBuilder has them ("LHipJoint", "LowerBack");
//            T-pose
//
// In a T- or A-pose upper arms, forearms and hands lie in one line, thighs and shins straight down;
// trunk, neck, head and feet are as in SMPL's rest pose. Y up, facing +Z, left = +X. The axes of
// all joints are the world's in the rest pose: rotations of zero are the rest pose.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/out_scheme.h"
#include "motion/skeleton.h"

namespace mocaplm {

struct OutJoint {
  std::string name;
  int parent = -1;          // index of a joint before this one; -1 for the root
  int smpl = -1;            // the joint of SMPL's that lies here; -1: an addition of the scheme's
  bool turns = true;        // false: rigid with its parent
  bool travels = false;     // its translation is the figure's way; the one joint at the pelvis
  Eigen::Vector3d rest;     // in the rest pose, metres, the pelvis where SMPL's rest pose has it
  Eigen::Quaterniond turn;  // from SMPL's rest pose to this one, about the world's axes
  // SMPL joints whose local rotations, one after the other, are this joint's against its parent,
  // but for what the rest poses differ.
  std::vector<int> path;
  std::optional<Eigen::Vector3d> end;  // where a bone ends that has no joint there, from the joint
};

struct OutSkeleton {
  OutScheme scheme = OutScheme::smpl;
  std::vector<OutJoint> joints;        // parents before children, in the scheme's order
  std::array<int, kJoints> of_smpl{};  // the joint that turns as SMPL's does
  double lift = 0;                     // raises the rest pose so that its soles lie at height 0
};

// How the feet of a T-pose stand: as SMPL's rest pose has them, turned out by 12 degrees, or
// straight ahead, as VRM asks for.
enum class RestFeet { natural, straight };

// The skeleton of `scheme` with the bones of the clip's body.
OutSkeleton out_skeleton(const Clip& clip, OutScheme scheme, RestFeet feet = RestFeet::natural);

// A joint's rotation against its parent in one frame.
Eigen::Quaterniond out_rotation(const OutSkeleton& skeleton, const Clip& clip, Eigen::Index frame,
                                std::size_t joint);
// Where the travelling joint lies in one frame, metres, in the world; all joints above it lie at
// the origin without rotation.
Eigen::Vector3d out_place(const Clip& clip, Eigen::Index frame);

// One frame of the clip's body that stands in the skeleton's rest pose, the pelvis where SMPL's
// rest pose has it.
Clip out_rest_pose(const OutSkeleton& skeleton, const Clip& clip);

}  // namespace mocaplm
