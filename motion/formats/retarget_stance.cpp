#include "motion/formats/retarget_stance.h"

#include <Eigen/Geometry>
#include <cmath>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

const Eigen::Vector3d& at(const BvhPose& pose, const SourceJoints& joints, int joint) {
  return pose.positions[static_cast<std::size_t>(joints[static_cast<std::size_t>(joint)])];
}

Eigen::Vector3d middle(const BvhPose& pose, const SourceJoints& joints, int left, int right) {
  return 0.5 * (at(pose, joints, left) + at(pose, joints, right));
}

// Sum of the directions from right to left, at the hips and shoulders.
Eigen::Vector3d leftward(const BvhPose& pose, const SourceJoints& joints) {
  return (at(pose, joints, 1) - at(pose, joints, 2)).normalized() +
         (at(pose, joints, 16) - at(pose, joints, 17)).normalized();
}

Eigen::Vector3d nearest_axis(const Eigen::Vector3d& v) {
  Eigen::Index axis;
  v.cwiseAbs().maxCoeff(&axis);
  return (v[axis] < 0 ? -1 : 1) * Eigen::Vector3d::Unit(axis);
}

// "+x", "-y", ... as a vector.
Eigen::Vector3d named_axis(const std::string& name) {
  return (name[0] == '-' ? -1 : 1) * Eigen::Vector3d::Unit(name[1] - 'x');
}

// Within 20 degrees.
bool along(const Eigen::Vector3d& v, const Eigen::Vector3d& axis) {
  return v.dot(axis) > 0.94 * v.norm() && v.norm() > 0;
}

// The signed axes of the file along which the figure of the zero pose stands and has its left.
struct Stance {
  Eigen::Vector3d up, left;
  bool stands;
};

Stance zero_stance(const Bvh& bvh, const SourceJoints& joints) {
  const BvhPose pose = rest_bvh(bvh);
  const Eigen::Vector3d hips = middle(pose, joints, 1, 2);
  const Eigen::Vector3d trunk = middle(pose, joints, 16, 17) - hips;
  const Eigen::Vector3d legs = hips - middle(pose, joints, 7, 8), left = leftward(pose, joints);
  Stance stance{nearest_axis(trunk), nearest_axis(left), false};
  stance.stands = along(trunk, stance.up) && along(legs, stance.up) && along(left, stance.left) &&
                  stance.up.dot(stance.left) == 0;
  return stance;
}

// World rotation of each source joint in the T-pose, in the file's world.
BvhPose t_pose_of_map(const Bvh& bvh, const RetargetMap& map, const std::string& file) {
  if (map.t_pose == TPose::zero) return rest_bvh(bvh);
  BvhPose pose;
  if (map.t_pose == TPose::frame) {
    if (map.frame >= bvh.frames())
      throw DataError(in_file(file),
                      "has " + std::to_string(bvh.frames()) + " frames, but its map " + map.scheme +
                          " takes the T-pose from frame " + std::to_string(map.frame));
    pose_bvh(bvh, map.frame, pose);
    return pose;
  }
  std::vector<double> values(static_cast<std::size_t>(bvh.channels()), 0.0);
  for (const auto& [name, degrees] : map.euler) {
    const int index = bvh.joint(name);
    if (index < 0)
      throw DataError(in_file(file),
                      "has no joint \"" + name + "\", which its map " + map.scheme + " turns");
    const BvhJoint& joint = bvh.joints[static_cast<std::size_t>(index)];
    std::size_t next = 0;
    for (std::size_t c = 0; c < joint.channels.size(); ++c)
      if (joint.channels[c] >= BvhChannel::x_rotation) {
        if (next < degrees.size())
          values[static_cast<std::size_t>(joint.first_channel) + c] = degrees[next];
        ++next;
      }
    if (next != degrees.size())
      throw DataError(in_file(file), "joint \"" + name + "\" has " + std::to_string(next) +
                                         " rotation channels, but map " + map.scheme + " gives " +
                                         std::to_string(degrees.size()) + " angles");
  }
  pose_bvh_values(bvh, values.data(), pose);
  return pose;
}

// Turns about Y so that the pose's left is +X.
Eigen::Matrix3d heading_to_front(const Eigen::Vector3d& left) {
  const double angle = std::atan2(left.z(), left.x());  // R_y(angle) (cos, 0, sin) = (1, 0, 0)
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

// How far the shin of the zero pose is spread to the side, as the turn about +Z that undoes it. The
// original CMU skeleton stands with its legs 20 degrees apart, and its feet tilted with them.
Eigen::Matrix3d undo_spread(const BvhPose& pose, const SourceJoints& joints,
                            const Eigen::Matrix3d& turn, int knee, int ankle) {
  const Eigen::Vector3d shin = turn * (at(pose, joints, ankle) - at(pose, joints, knee));
  const double angle = std::atan2(shin.x(), -shin.y());
  if (std::abs(angle) < 0.175) return Eigen::Matrix3d::Identity();  // 10 degrees: straight
  return Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

SourceJoints source_joints(const Bvh& bvh, const RetargetMap& map, const std::string& file) {
  SourceJoints joints;
  joints.fill(-1);
  std::vector<std::string> absent, unnamed;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (map.joints[j].empty()) continue;
    joints[j] = bvh.joint(map.joints[j]);
    if (joints[j] < 0) absent.push_back(map.joints[j]);
  }
  for (const int j : required_joints())
    if (map.joints[static_cast<std::size_t>(j)].empty())
      unnamed.push_back(joint_names()[static_cast<std::size_t>(j)]);
  if (!absent.empty())
    throw DataError(in_file(file), "has no joint " + join(absent, ", ") + ", which its map " +
                                       map.scheme + " names");
  if (!unnamed.empty())
    throw DataError(in_file(map.scheme),
                    "the map names no source joint for " + join(unnamed, ", "));
  return joints;
}

bool zero_pose_stands(const Bvh& bvh, const RetargetMap& map) {
  return zero_stance(bvh, source_joints(bvh, map, map.scheme)).stands;
}

Eigen::Matrix3d world_turn(const Bvh& bvh, const RetargetMap& map, UpAxis option,
                           const std::string& file) {
  Eigen::Vector3d up = Eigen::Vector3d::UnitY(), facing = Eigen::Vector3d::UnitZ();
  bool up_known = option != UpAxis::automatic || !map.up.empty();
  if (option != UpAxis::automatic)
    up = Eigen::Vector3d::Unit(option == UpAxis::z ? 2 : 1);
  else if (!map.up.empty())
    up = named_axis(map.up);
  if (up.z() != 0) facing = -Eigen::Vector3d::UnitY();
  if (up.x() != 0) facing = Eigen::Vector3d::UnitZ();
  if (map.t_pose == TPose::zero) {
    const Stance stance = zero_stance(bvh, source_joints(bvh, map, file));
    if (stance.stands && !up_known) up = stance.up;
    if (stance.stands && stance.left.dot(up) == 0) facing = stance.left.cross(up);
  }
  if (!map.facing.empty()) facing = named_axis(map.facing);
  if (facing.dot(up) != 0)
    throw DataError(in_file(file),
                    "up and facing of its map " + map.scheme + " lie along the same axis");
  Eigen::Matrix3d turn;
  turn << up.cross(facing).transpose(), up.transpose(), facing.transpose();
  return turn;
}

std::array<Eigen::Matrix3d, kJoints> from_t_pose(const Bvh& bvh, const RetargetMap& map,
                                                 const SourceJoints& joints,
                                                 const Eigen::Matrix3d& turn,
                                                 const std::string& file) {
  std::array<Eigen::Matrix3d, kJoints> inverse;
  inverse.fill(Eigen::Matrix3d::Identity());
  BvhPose pose;
  Eigen::Matrix3d front = turn;
  if (map.t_pose != TPose::axes) {
    pose = t_pose_of_map(bvh, map, file);
    if (map.t_pose == TPose::frame) front = heading_to_front(turn * leftward(pose, joints)) * turn;
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (joints[j] < 0) continue;
    if (map.t_pose != TPose::axes) {
      inverse[j] = (front * pose.rotations[static_cast<std::size_t>(joints[j])]).transpose();
      const bool left_foot = j == 7 || j == 10, right_foot = j == 8 || j == 11;
      if (map.t_pose == TPose::zero && map.align && (left_foot || right_foot))
        inverse[j] *=
            undo_spread(pose, joints, turn, left_foot ? 4 : 5, left_foot ? 7 : 8).transpose();
      continue;
    }
    const auto found = map.axes.find(map.joints[j]);
    if (found == map.axes.end())
      throw DataError(in_file(map.scheme),
                      "the map says no T-pose axes for joint \"" + map.joints[j] + "\"");
    const JointAxes& axes = found->second;
    Eigen::Matrix3d t_pose;
    t_pose << axes.x, axes.y, axes.x.cross(axes.y);
    inverse[j] = t_pose.transpose();
  }
  return inverse;
}

double figure_height(const Bvh& bvh, const SourceJoints& joints) {
  BvhPose pose;
  pose_bvh(bvh, 0, pose);
  const auto bone = [&](int a, int b) {
    return (at(pose, joints, a) - at(pose, joints, b)).norm();
  };
  const double leg = 0.5 * (bone(1, 4) + bone(4, 7) + bone(2, 5) + bone(5, 8));
  const double trunk = (middle(pose, joints, 1, 2) - middle(pose, joints, 16, 17)).norm();
  return 1.29 * (leg + trunk);  // SMPL's neutral body: 1.70 m from 1.32 m of legs and trunk
}

}  // namespace mocaplm
