// Limb directions as rotations of SMPL's joints again, and where the body then stands.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "emulator/landmarks.h"

namespace mocaplm {

// A direction leaves the turn of a joint about its limb open. This is that turn in radians, (n, T),
// a row a landmark: how far the joint's rotation is turned about its limb from the one that swings
// there from its parent's rotation by the shortest way. Zero for landmarks with no limb below them,
// and with several, whose directions leave nothing open.
Eigen::MatrixXd limb_turns(const Clip& clip, const LandmarkTree& tree);

// The turns of a clip at these times, in frames, along the shorter way between two frames.
Eigen::MatrixXd turns_at(const Eigen::MatrixXd& turns, const Eigen::VectorXd& times);
// The mean direction of angles, each of (n, T).
Eigen::MatrixXd mean_turns(const std::vector<Eigen::MatrixXd>& turns);

// Joint rotations whose forward kinematics on SMPL's mean body has these limb directions. With the
// turns of a clip they are that clip's rotations, but for joints without a limb below them. `turns`
// may be empty: zero. Joints that are no landmarks, and those without a limb below them, keep
// their parent's rotation. Where a joint has several limbs (pelvis, chest), which the body holds
// at fixed angles and a sample does not, the rotation is the nearest in the least squares sense.
// The root's translation keeps the lower foot on the ground (height 0) and, while it is the lower
// one, in its place. `tree` is one that smpl_landmarks makes.
Clip postures_clip(const PostureSequence& sequence, const LandmarkTree& tree,
                   const Eigen::MatrixXd& turns, double fps, const std::string& name);

}  // namespace mocaplm
