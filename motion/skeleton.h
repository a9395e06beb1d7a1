// SMPL's kinematic tree of 24 joints and the rest pose of the neutral body (Loper et al. 2015;
// beta = 0, published constants, about +-3e-4 m). Y up, facing +Z, T-pose, left is +X.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

constexpr int kJoints = 24;

// (joints, 3) metres.
using JointPositions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

// Parent of each joint, -1 for the pelvis; a parent comes before its children.
const std::array<int, kJoints>& joint_parents();
// "pelvis", "left_hip", ... SMPL's order.
const std::array<std::string, kJoints>& joint_names();
// The same joint on the other side of the body, itself for the spine and head.
const std::array<int, kJoints>& mirrored_joints();
// (24, 3) positions in the rest pose of the mean body, metres.
const RestJoints& rest_joints();
// The same of the clip's own body where its shape is known, else of the mean body.
const RestJoints& rest_joints(const Clip& clip);

// Index of a joint by name, or -1.
int joint_index(const std::string& name);

// The thesis's 13 joints (Table A.1): pelvis, hips, knees, ankles, shoulders, elbows, wrists.
const std::vector<int>& thesis_joints();

// Joints for what a user writes: joint names and groups ("right_arm", "left_leg", "spine", "root"),
// each once, in SMPL's order. Throws UsageError with the nearest known name.
std::vector<int> parse_joints(const std::vector<std::string>& names);
// The groups that parse_joints knows, with their joints.
const std::vector<std::pair<std::string, std::vector<int>>>& joint_groups();

// Forward kinematics of one frame: world positions (24, 3) in metres.
JointPositions joint_positions(const Clip& clip, Eigen::Index frame);
// World rotation matrix of every joint of one frame.
std::array<Eigen::Matrix3d, kJoints> joint_world_rotations(const Clip& clip, Eigen::Index frame);

}  // namespace mocaplm
