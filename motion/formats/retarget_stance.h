// How a skeleton stands: which way is up and forward, and its T-pose.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "motion/formats/bvh.h"
#include "motion/formats/retarget_map.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

// Index of the source joint of every SMPL joint, -1 for none.
using SourceJoints = std::array<int, kJoints>;
// Throws DataError naming the joints that the file lacks and those that the map must name.
SourceJoints source_joints(const Bvh& bvh, const RetargetMap& map, const std::string& file);

// Turns the file's world into ours: Y up, and the figure faces +Z where its T-pose faces `facing`.
Eigen::Matrix3d world_turn(const Bvh& bvh, const RetargetMap& map, UpAxis up,
                           const std::string& file);

// For each SMPL joint the matrix B with which world rotation (in our world) times B is the rotation
// relative to the T-pose: B = (the joint's world rotation in the T-pose)^-1.
std::array<Eigen::Matrix3d, kJoints> from_t_pose(const Bvh& bvh, const RetargetMap& map,
                                                 const SourceJoints& joints,
                                                 const Eigen::Matrix3d& turn,
                                                 const std::string& file);

// The figure's height in the file's units, from its legs and trunk in the first frame.
double figure_height(const Bvh& bvh, const SourceJoints& joints);

}  // namespace mocaplm
