#include "motion/formats/skeleton_names.h"

namespace mocaplm {

namespace {

void set_spine(SkeletonNames& names, const char* first, const char* second, const char* third,
               const char* fourth = "") {
  names.spine[0] = first;
  names.spine[1] = second;
  names.spine[2] = third;
  names.spine[3] = fourth;
}

// The "no fingers" skeleton that Mixamo's auto-rigger gives.
SkeletonNames mixamo() {
  SkeletonNames names;
  names.prefix = "mixamorig:";
  set_spine(names, "Spine", "Spine1", "Spine2");
  names.head_end = "HeadTop_End";
  names.shoulder = "*Arm";
  names.elbow = "*ForeArm";
  names.hip = "*UpLeg";
  names.knee = "*Leg";
  names.foot = "*ToeBase";
  names.toe_end = "*Toe_End";
  return names;
}

// UnityEngine.HumanBodyBones.
SkeletonNames unity() {
  SkeletonNames names;
  set_spine(names, "Spine", "Chest", "UpperChest");
  names.shoulder = "*UpperArm";
  names.elbow = "*LowerArm";
  names.hip = "*UpperLeg";
  names.knee = "*LowerLeg";
  names.foot = "*Toes";
  names.legs_first = true;
  return names;
}

// VRMC_vrm-1.0, humanoid.
SkeletonNames vrm() {
  SkeletonNames names = unity();
  names.left = "left";
  names.right = "right";
  names.pelvis = "hips";
  set_spine(names, "spine", "chest", "upperChest");
  names.neck = "neck";
  names.head = "head";
  names.legs_first = false;
  return names;
}

SkeletonNames unreal() {
  SkeletonNames names;
  names.left = "l";
  names.right = "r";
  names.root = "root";
  names.pelvis = "pelvis";
  set_spine(names, "spine_01", "spine_02", "spine_03");
  names.neck = "neck_01";
  names.head = "head";
  names.collar = "clavicle_*";
  names.shoulder = "upperarm_*";
  names.elbow = "lowerarm_*";
  names.wrist = "hand_*";
  names.hip = "thigh_*";
  names.knee = "calf_*";
  names.ankle = "foot_*";
  names.foot = "ball_*";
  names.neck_at = SkeletonNames::NeckAt::last;
  names.arms_down_degrees = 45;
  return names;
}

SkeletonNames rokoko() {
  SkeletonNames names;
  names.root = "Root";
  set_spine(names, "Spine1", "Spine2", "Spine3", "Spine4");
  names.shoulder = "*Arm";
  names.elbow = "*ForeArm";
  names.hip = "*Thigh";
  names.knee = "*Shin";
  names.foot = "*Toe";
  names.toe_end = "*ToeTip";
  names.legs_first = true;
  names.neck_at = SkeletonNames::NeckAt::between_the_arms;
  return names;
}

// The database's joints as its conversions to .bvh for MotionBuilder name them.
SkeletonNames cmu() {
  SkeletonNames names;
  set_spine(names, "LowerBack", "Spine", "Spine1");
  names.neck1 = "Neck1";
  names.shoulder = "*Arm";
  names.elbow = "*ForeArm";
  names.hand = "*FingerBase";
  names.left_hip_joint = "LHipJoint";
  names.right_hip_joint = "RHipJoint";
  names.hip = "*UpLeg";
  names.knee = "*Leg";
  names.foot = "*ToeBase";
  names.legs_first = true;
  return names;
}

}  // namespace

const SkeletonNames& skeleton_names(OutScheme scheme) {
  // In the enum's order, after smpl.
  static const SkeletonNames all[] = {SkeletonNames(), mixamo(), unity(), unreal(),
                                      vrm(),           rokoko(), cmu()};
  return all[static_cast<std::size_t>(scheme)];
}

}  // namespace mocaplm
