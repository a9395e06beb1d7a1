// How a limb of two bones is turned about itself, over time: positions say where its bones point,
// the plane in which it bends says the rest.
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace mocaplm {

// Bones of a limb in the rest pose (unit vectors) and the axis of its hinge: turning `lower` about
// it by a positive angle bends the limb as elbows and knees bend.
struct LimbRest {
  Eigen::Vector3d upper, lower, hinge;
};

// The rotations of the upper bone, one a frame, each turning rest.upper exactly into upper[t]. All
// directions are unit vectors in the frame of the bone's parent. About itself the bone is turned so
// that the lower one follows by the hinge alone; where the limb is nearly straight, and its plane
// is noise, the turn goes on smoothly from bend to bend and tends to that of the shortest way from
// the rest pose. Least squares over the whole clip, so no frame flips.
std::vector<Eigen::Quaterniond> limb_rotations(const LimbRest& rest,
                                               const std::vector<Eigen::Vector3d>& upper,
                                               const std::vector<Eigen::Vector3d>& lower,
                                               double fps);

// The rotation that brings the frame of (first, second) onto that of (to_first, to_second): first
// exactly onto to_first, second as near to to_second as can be. No pair may be parallel.
Eigen::Quaterniond frame_rotation(const Eigen::Vector3d& first, const Eigen::Vector3d& second,
                                  const Eigen::Vector3d& to_first,
                                  const Eigen::Vector3d& to_second);

}  // namespace mocaplm
