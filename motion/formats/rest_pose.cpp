#include "motion/formats/rest_pose.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/error.h"
#include "motion/rotation.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

// "+x", "-y", ... as a vector.
Eigen::Vector3d named_axis(const std::string& name) {
  return (name[0] == '-' ? -1 : 1) * Eigen::Vector3d::Unit(name[1] - 'x');
}

// Forward kinematics from world rotations that are given for some joints; others keep their
// parent's.
void place(const Bvh& bvh, const std::vector<bool>& given, BvhPose& pose) {
  pose.positions.resize(bvh.joints.size());
  for (std::size_t i = 0; i < bvh.joints.size(); ++i) {
    const int parent = bvh.joints[i].parent;
    if (!given[i])
      pose.rotations[i] =
          parent < 0 ? Eigen::Matrix3d::Identity().eval() : pose.rotations[joint_index(parent)];
    pose.positions[i] =
        parent < 0 ? bvh.joints[i].offset
                   : Eigen::Vector3d(pose.positions[joint_index(parent)] +
                                     pose.rotations[joint_index(parent)] * bvh.joints[i].offset);
  }
}

class RestFinder {
 public:
  RestFinder(const Bvh& bvh, const RetargetMap& map, const SourceFigure& figure,
             const std::string& file)
      : bvh_(bvh), map_(map), figure_(figure), file_(file) {}

  RestPose find() {
    if (!map_.up.empty() && !map_.facing.empty() && map_.up[1] == map_.facing[1])
      throw DataError(in_file(file_),
                      "up and facing of its map " + map_.scheme + " lie along the same axis");
    switch (map_.t_pose) {
      case TPose::axes:
        return standing_axes();
      case TPose::euler:
        return of_angles(euler_pose());
      case TPose::frame:
        return of_pose(frame_pose(map_.frame), "frame " + std::to_string(map_.frame), false);
      case TPose::automatic:
        break;
    }
    const BvhPose zero = rest_bvh(bvh_);
    const Standing standing = standing_in(figure_, zero, false);
    // Arms that hang may as well be lifted by chance; a later pose may tell more.
    if (standing.stance != RestStance::none && standing.stance != RestStance::hanging)
      return of_zero(zero, standing);
    if (!map_.axes.empty()) {
      RestPose known = axes_pose();
      if (stands(known)) return known;
    }
    const BvhPose first = frame_pose(0);
    const Standing in_first = standing_in(figure_, first, true);
    if (in_first.stance == RestStance::t_pose || in_first.stance == RestStance::a_pose)
      return of_pose(first, "frame 0", true);
    if (standing.stance == RestStance::hanging) return of_zero(zero, standing);
    RestPose straightened = straighten();
    if (stands(straightened)) return straightened;
    throw DataError(in_file(file_),
                    "shows no T-pose or A-pose from which its rotations could be told: with all "
                    "rotations zero " +
                        standing.why_not + ", in frame 0 " +
                        (in_first.why_not.empty() ? "the arms hang" : in_first.why_not) +
                        ". Give a map that says how a T-pose is got (--bvh-map, "
                        "docs/bvh-maps.md)");
  }

 private:
  // Turned so that +Y is up and +X left: by whole axes where the figure stands along them.
  Eigen::Matrix3d front_of(const Standing& standing) const {
    Eigen::Vector3d up = map_.up.empty() ? standing.up : named_axis(map_.up);
    const Eigen::Vector3d axis = nearest_axis(standing.left);
    if (!map_.facing.empty()) return to_front(up, up.cross(named_axis(map_.facing)));
    const bool along = standing.left.dot(axis) > 0.94 && axis.dot(up) == 0;  // within 20 degrees
    return to_front(up, along ? axis : Eigen::Vector3d(standing.left));
  }

  RestPose of_zero(const BvhPose& zero, const Standing& standing) const {
    RestPose rest{zero, front_of(standing), standing.up, true, standing.stance, "the zero pose"};
    if (!map_.up.empty()) rest.up = named_axis(map_.up);
    return rest;
  }

  // Along the file's axes.
  RestPose of_angles(const BvhPose& pose) const {
    RestPose rest = of_pose(pose, "the map's angles", false);
    rest.front = front_of(standing_in(figure_, pose, false));
    return rest;
  }

  // At any heading.
  RestPose of_pose(const BvhPose& pose, const std::string& source, bool known_to_stand) const {
    const Standing standing = standing_in(figure_, pose, false);
    if (standing.stance == RestStance::none && !known_to_stand)
      throw DataError(in_file(file_), "is to stand in a T-pose in " + source + ", as its map " +
                                          map_.scheme + " says, but " + standing.why_not);
    return {pose,  to_front(standing.up, standing.left), standing.up, false, standing.stance,
            source};
  }

  BvhPose frame_pose(Eigen::Index frame) const {
    if (frame >= bvh_.frames())
      throw DataError(in_file(file_), "has " + std::to_string(bvh_.frames()) +
                                          " frames, but its map " + map_.scheme +
                                          " takes the T-pose from frame " + std::to_string(frame));
    BvhPose pose;
    pose_bvh(bvh_, frame, pose);
    return pose;
  }

  BvhPose euler_pose() const {
    std::vector<double> values(joint_index(bvh_.channels()), 0.0);
    for (const auto& [name, degrees] : map_.euler) {
      const int found = bvh_.joint(name);
      if (found < 0)
        throw DataError(in_file(file_),
                        "has no joint \"" + name + "\", which its map " + map_.scheme + " turns");
      const BvhJoint& joint = bvh_.joints[joint_index(found)];
      std::size_t next = 0;
      for (std::size_t c = 0; c < joint.channels.size(); ++c) {
        if (joint.channels[c] < BvhChannel::x_rotation) continue;
        if (next < degrees.size()) values[joint_index(joint.first_channel) + c] = degrees[next];
        ++next;
      }
      if (next != degrees.size())
        throw DataError(in_file(file_), "joint \"" + name + "\" has " + std::to_string(next) +
                                            " rotation channels, but map " + map_.scheme +
                                            " gives " + std::to_string(degrees.size()) + " angles");
    }
    // Where the joints stand is the OFFSETs' matter.
    for (const BvhJoint& joint : bvh_.joints)
      for (std::size_t c = 0; c < joint.channels.size(); ++c)
        if (joint.channels[c] < BvhChannel::x_rotation)
          values[joint_index(joint.first_channel) + c] =
              joint.offset[static_cast<int>(joint.channels[c])];
    BvhPose pose;
    pose_bvh_values(bvh_, values.data(), pose);
    return pose;
  }

  // The axes of the map's joints as they lie in a T-pose.
  RestPose axes_pose() const {
    RestPose rest;
    rest.front = Eigen::Matrix3d::Identity();
    rest.source = "the known axes of its joints";
    rest.pose.rotations.resize(bvh_.joints.size());
    std::vector<bool> given(bvh_.joints.size(), false);
    for (int j = 0; j < kJoints; ++j) {
      if (!figure_.has(j)) continue;
      const auto found = map_.axes.find(map_.joints[joint_index(j)]);
      if (found == map_.axes.end())
        throw DataError(in_file(map_.scheme), "the map says no T-pose axes for joint \"" +
                                                  map_.joints[joint_index(j)] + "\"");
      const JointAxes& axes = found->second;
      rest.pose.rotations[joint_index(figure_.source(j))] << axes.x, axes.y, axes.x.cross(axes.y);
      given[joint_index(figure_.source(j))] = true;
    }
    place(bvh_, given, rest.pose);
    return rest;
  }
  RestPose standing_axes() const {
    RestPose rest = axes_pose();
    const Standing standing = standing_in(figure_, rest.pose, false);
    if (!stands(rest))
      throw DataError(
          in_file(map_.scheme),
          "with the axes of this map the figure of " + file_ + " does not stand: " +
              (standing.why_not.empty() ? "it does not face +Z with +Y up" : standing.why_not));
    return rest;
  }
  // In our world, facing +Z.
  bool stands(const RestPose& rest) const {
    const Standing standing = standing_in(figure_, rest.pose, false);
    return standing.stance != RestStance::none && standing.up == Eigen::Vector3d::UnitY() &&
           standing.left.x() > 0.9;
  }

  // World rotation that brings the bones of one joint where SMPL's lie, in the least-squares sense.
  Eigen::Matrix3d fit(const BvhPose& zero, int from, const std::vector<int>& ends) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const int end : ends) {
      if (!figure_.has(end)) continue;
      const Eigen::Vector3d bone = figure_.at(zero, end) - figure_.at(zero, from);
      if (bone.norm() < 1e-9) continue;
      sum += rest_bone(from, end).normalized() * bone.normalized().transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
    flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    return svd.matrixU() * flip * svd.matrixV().transpose();
  }

  // How a limb's upper joint is turned about its own bone cannot be seen from bones that lie
  // straight, but from the way in which its elbow or knee bends: the mean of upper bone x lower
  // bone over some frames, in the joint's own axes. Zero where it hardly bends.
  Eigen::Vector3d hinge(int upper) const {
    const int middle = upper < 16 ? upper + 3 : upper + 2, end = upper < 16 ? upper + 6 : upper + 4;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double all = 0;
    BvhPose pose;
    const Eigen::Index step = std::max<Eigen::Index>(1, bvh_.frames() / 64);
    for (Eigen::Index t = 0; t < bvh_.frames(); t += step) {
      pose_bvh(bvh_, t, pose);
      const Eigen::Vector3d bone =
          (figure_.at(pose, middle) - figure_.at(pose, upper)).normalized();
      const Eigen::Vector3d next = (figure_.at(pose, end) - figure_.at(pose, middle)).normalized();
      const Eigen::Vector3d axis = bone.cross(next);
      if (!(axis.norm() > 0.25)) continue;  // some 15 degrees
      sum += pose.rotations[joint_index(figure_.source(upper))].transpose() * axis;
      all += axis.norm();
    }
    return all > 0 && sum.norm() > 0.7 * all ? sum.normalized() : Eigen::Vector3d::Zero().eval();
  }

  // About its bone, so that the limb bends as people's do: knees backwards, elbows forwards.
  Eigen::Matrix3d twisted(const Eigen::Matrix3d& world, int upper,
                          const Eigen::Vector3d& bone) const {
    const Eigen::Vector3d axis = world * hinge(upper);
    const Eigen::Vector3d wanted =
        upper < 16 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d(0, upper == 16 ? -1 : 1, 0);
    const Eigen::Vector3d along = bone.normalized();
    const Eigen::Vector3d from = axis - axis.dot(along) * along;
    const Eigen::Vector3d to = wanted - wanted.dot(along) * along;
    if (from.norm() < 0.5 || to.norm() < 0.5) return world;
    const double angle = std::atan2(from.cross(to).dot(along), from.dot(to));
    // Less is how people differ, and what shortest turns have right.
    if (std::abs(angle) < 0.8) return world;
    return Eigen::AngleAxisd(angle, along).toRotationMatrix() * world;
  }

  RestPose straighten() const {
    const BvhPose zero = rest_bvh(bvh_);
    RestPose rest;
    rest.front = Eigen::Matrix3d::Identity();
    rest.source = "the directions of its bones";
    rest.pose.rotations.resize(bvh_.joints.size());
    std::vector<bool> given(bvh_.joints.size(), false);
    // Each joint's bone that shows where it points.
    constexpr int kNext[kJoints] = {-1, 4,  5,  6,  7,  8,  9,  10, 11, -1, -1, -1,
                                    15, 16, 17, -1, 18, 19, 20, 21, 22, 23, -1, -1};
    for (std::size_t i = 0; i < bvh_.joints.size(); ++i) {
      const int parent = bvh_.joints[i].parent;
      const Eigen::Matrix3d above = parent < 0 ? Eigen::Matrix3d::Identity().eval()
                                               : rest.pose.rotations[joint_index(parent)];
      rest.pose.rotations[i] = above;
      given[i] = true;
      int smpl = -1;
      for (int j = 0; j < kJoints; ++j)
        if (figure_.source(j) == static_cast<int>(i)) smpl = j;
      if (smpl == 0)
        rest.pose.rotations[i] = fit(zero, 0, {1, 2, figure_.has(3) ? 3 : figure_.has(6) ? 6 : 9});
      if (smpl == 9) {
        const int left = figure_.has(13) ? 13 : 16;
        rest.pose.rotations[i] = fit(zero, 9, {left, left + 1, figure_.has(12) ? 12 : 15});
      }
      if (smpl < 0 || kNext[joint_index(smpl)] < 0) continue;
      int next = kNext[joint_index(smpl)];
      while (next >= 0 && !figure_.has(next)) next = next < 12 ? kNext[joint_index(next)] : -1;
      if (next < 0) continue;
      const Eigen::Vector3d bone = figure_.at(zero, next) - figure_.at(zero, smpl);
      if (bone.norm() < 1e-9) continue;
      rest.pose.rotations[i] =
          shortest_rotation(above * bone, rest_bone(smpl, next)).toRotationMatrix() * above;
      if (smpl == 1 || smpl == 2 || smpl == 16 || smpl == 17)
        rest.pose.rotations[i] = twisted(rest.pose.rotations[i], smpl, rest_bone(smpl, next));
    }
    place(bvh_, given, rest.pose);
    return rest;
  }

  const Bvh& bvh_;
  const RetargetMap& map_;
  const SourceFigure& figure_;
  const std::string& file_;
};

}  // namespace

RestPose find_rest_pose(const Bvh& bvh, const RetargetMap& map, const SourceFigure& figure,
                        const std::string& file) {
  return RestFinder(bvh, map, figure, file).find();
}

}  // namespace mocaplm
