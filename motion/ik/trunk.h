// Pelvis, spine, chest, collars, neck and head of the figure from positions, frame by frame.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "motion/ik/points.h"

namespace mocaplm {

// World rotation of every joint of a frame.
using WorldRotations = std::array<Eigen::Quaterniond, kJoints>;

// Which of the source's points mean what SMPL's joints mean. Files that share the names often do
// not: a pelvis in the middle of the hips, collars at the throat, a neck between the shoulders.
struct TrunkPoints {
  bool pelvis_is_middle = false;
  bool pelvis = false, spine = false, collars = false, neck = false, head = false;
  // The figure's length over the source's, by medians: from the middle of the hips to that of the
  // shoulders, and from shoulder to shoulder.
  double trunk_scale = 1, shoulder_scale = 1;
};
TrunkPoints trunk_points(const PointTracks& tracks);

// Direction from a to b, by `fallback` where they coincide.
Eigen::Vector3d direction(const PointTracks& tracks, Eigen::Index frame, int a, int b,
                          const Eigen::Vector3d& fallback);

// Sets the rotations of pelvis (0), spine (3, 6, 9), neck (12), collars (13, 14) and head (15).
// `before`: the frame before, for what cannot be told in this one; null for the first.
void pose_trunk(const PointTracks& tracks, const TrunkPoints& points, Eigen::Index frame,
                const WorldRotations* before, WorldRotations& world);

}  // namespace mocaplm
