// Small geometry that several files of motion need.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "common/angles.h"
#include "motion/skeleton.h"

namespace mocaplm {

// A joint of the mean body at rest, metres.
inline Eigen::Vector3d rest_joint(int joint) {
  return rest_joints().row(joint).transpose();
}
// Its bone from joint a to joint b.
inline Eigen::Vector3d rest_bone(int a, int b) {
  return rest_joint(b) - rest_joint(a);
}

// Radians, 0 to pi; exact for small angles too.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// `angle` with the whole turns that bring it nearest to `previous`.
inline double nearest_turn(double angle, double previous) {
  return angle + 2 * kPi * std::round((previous - angle) / (2 * kPi));
}

// The right-handed frame whose first axis is `along` and whose second is as near to `across` as can
// be. They must not be parallel.
inline Eigen::Matrix3d frame_along(const Eigen::Vector3d& along, const Eigen::Vector3d& across) {
  Eigen::Matrix3d frame;
  frame.col(0) = along.normalized();
  frame.col(1) = (across - across.dot(frame.col(0)) * frame.col(0)).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace mocaplm
