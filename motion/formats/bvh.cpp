#include "motion/formats/bvh.h"

#include <cmath>

namespace mocaplm {

namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

// rotation * R(axis, angle), which only mixes the two other columns.
void rotate(Eigen::Matrix3d& rotation, int axis, double degrees) {
  const double c = std::cos(degrees * kRadians), s = std::sin(degrees * kRadians);
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  const Eigen::Vector3d u = rotation.col(j), v = rotation.col(k);
  rotation.col(j) = c * u + s * v;
  rotation.col(k) = c * v - s * u;
}

}  // namespace

int Bvh::joint(const std::string& name) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == name) return static_cast<int>(i);
  return -1;
}

void pose_bvh_values(const Bvh& bvh, const double* values, BvhPose& pose) {
  pose.rotations.resize(bvh.joints.size());
  pose.positions.resize(bvh.joints.size());
  for (std::size_t i = 0; i < bvh.joints.size(); ++i) {
    const BvhJoint& joint = bvh.joints[i];
    Eigen::Matrix3d& rotation = pose.rotations[i];
    Eigen::Vector3d position = joint.offset;
    if (joint.parent < 0)
      rotation.setIdentity();
    else
      rotation = pose.rotations[static_cast<std::size_t>(joint.parent)];
    const Eigen::Matrix3d parent_rotation = rotation;
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      const int kind = static_cast<int>(joint.channels[c]);
      const double value = values[static_cast<std::size_t>(joint.first_channel) + c];
      if (kind < 3)
        position[kind] = value;
      else
        rotate(rotation, kind - 3, value);
    }
    pose.positions[i] =
        joint.parent < 0 ? position
                         : Eigen::Vector3d(pose.positions[static_cast<std::size_t>(joint.parent)] +
                                           parent_rotation * position);
  }
}

void pose_bvh(const Bvh& bvh, Eigen::Index frame, BvhPose& pose) {
  pose_bvh_values(bvh, bvh.values.row(frame).data(), pose);
}

BvhPose rest_bvh(const Bvh& bvh) {
  BvhPose pose;
  for (const BvhJoint& joint : bvh.joints) {
    pose.rotations.push_back(Eigen::Matrix3d::Identity());
    pose.positions.push_back(
        joint.parent < 0 ? joint.offset
                         : Eigen::Vector3d(pose.positions[static_cast<std::size_t>(joint.parent)] +
                                           joint.offset));
  }
  return pose;
}

}  // namespace mocaplm
