#include "motion/formats/trunk.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/formats/recognise.h"
#include "motion/rotation.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

// Axes along `across`, and as near to `up` as that allows.
Eigen::Matrix3d frame(const Eigen::Vector3d& across, const Eigen::Vector3d& up) {
  Eigen::Matrix3d axes;
  axes.col(0) = across.normalized();
  axes.col(2) = across.cross(up).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// From the middle of SMPL's hips to the middle of its shoulders.
Eigen::Vector3d smpl_trunk(const Rotations& world) {
  return world[0] * (rest_joint(3) - 0.5 * (rest_joint(1) + rest_joint(2))) +
         world[3] * (rest_joint(6) - rest_joint(3)) + world[6] * (rest_joint(9) - rest_joint(6)) +
         world[9] * (0.5 * (rest_joint(16) + rest_joint(17)) - rest_joint(9));
}

}  // namespace

Trunk::Trunk(const Bvh& bvh, const std::vector<BvhPose>& poses, const SourceFigure& figure,
             const RestPose& rest_pose, const Eigen::Matrix3d& turn, bool keep_direction)
    : figure_(figure), turn_(turn), keep_(keep_direction) {
  const auto bone = [&](int from, int to) { return rest_pose.bone(figure, from, to); };
  const Eigen::Vector3d hips_middle = 0.5 * bone(1, 2);  // from the left hip
  hips_ = bone(2, 1);
  for (const int joint : {3, 6, 9, 12})
    if (base_ < 0 && figure.has(joint) &&
        (bone(1, joint) - hips_middle).norm() > 0.05 * figure.leg(rest_pose.pose))
      base_ = joint;
  lower_ = base_ < 0 ? Eigen::Vector3d(0.5 * (bone(1, 16) + bone(1, 17)) - hips_middle)
                     : Eigen::Vector3d(bone(1, base_) - hips_middle);
  if (figure.has(13) && figure.has(14) && bone(14, 13).norm() > 0.1 * bone(17, 16).norm())
    left_ = 13;
  shoulders_ = bone(left_ + 1, left_);
  trunk_ = 0.5 * (bone(0, 16) + bone(0, 17));
  const auto inverse = [&](int smpl) -> Eigen::Matrix3d {
    if (!figure.has(smpl)) return Eigen::Matrix3d::Identity();
    return (rest_pose.front * rest_pose.pose.rotations[joint_index(figure.source(smpl))])
        .transpose();
  };
  pelvis_rest_ = inverse(0);
  chest_rest_ = inverse(9);
  pelvis_off_ = hips_turn_apart(poses);
  chest_off_ = shoulders_turn_apart(bvh, poses);

  // How high the chest's joint lies, beside SMPL's spine1 and spine2; 0 at the hips.
  const Eigen::Vector3d whole = 0.5 * (bone(1, 16) + bone(1, 17)) - hips_middle;
  const double chest =
      figure.has(9) ? (bone(1, 9) - hips_middle).dot(whole) / whole.squaredNorm() : 1;
  // A single joint so low that SMPL's spine, which begins higher, cannot bend as far: the pelvis
  // bends with it.
  const bool single = figure.has(9) && !figure.has(6);
  const std::size_t joints =
      figure.has(9) ? path_down(bvh, common_ancestor(bvh, figure.source(0), figure.source(9)),
                                figure.source(9))
                          .size()
                    : 0;
  // What turns one for one with the source's joint stays as it is.
  bend_ = {single ? 0.8 * std::clamp((0.45 - chest) / 0.25, 0.0, 1.0) : 0.0,
           joints > 3 || !figure.has(3) ? 1.0 : 0.0, joints > 3 || !figure.has(6) ? 1.0 : 0.0};
  const Eigen::Vector3d smpl_hips = 0.5 * (rest_joint(1) + rest_joint(2));
  const Eigen::Vector3d smpl_whole = 0.5 * (rest_joint(16) + rest_joint(17)) - smpl_hips;
  for (const int k : {0, 1}) {
    const double height =
        (rest_joint(3 + 3 * k) - smpl_hips).dot(smpl_whole) / smpl_whole.squaredNorm();
    const double equal = (1.0 + k) / 3;
    share_[joint_index(k)] = !figure.has(9) ? equal : height >= chest - 0.02 ? 1 : height / chest;
  }
}

Eigen::Quaterniond Trunk::own_rotation(const BvhPose& pose, int smpl) const {
  return quaternion_from_matrix(turn_ * pose.rotations[joint_index(figure_.source(smpl))] *
                                (smpl == 0 ? pelvis_rest_ : chest_rest_));
}

// More than rounding, in any frame that is looked at.
bool Trunk::hips_turn_apart(const std::vector<BvhPose>& poses) const {
  for (const BvhPose& pose : poses) {
    if (angle_between(own_rotation(pose, 0) * hips_, source_bone(pose, 2, 1)) > 0.5 * kRadians)
      return true;
  }
  return false;
}

// The arms hang from another joint than the chest, or are turned against it as no shoulders are.
bool Trunk::shoulders_turn_apart(const Bvh& bvh, const std::vector<BvhPose>& poses) const {
  if (!figure_.has(9)) return true;
  const auto hangs = [&](int left) {
    return common_ancestor(bvh, figure_.source(left), figure_.source(left + 1));
  };
  if (figure_.has(left_) && hangs(left_) != figure_.source(9)) return true;
  std::size_t apart = 0;
  for (const BvhPose& pose : poses) {
    apart += angle_between(own_rotation(pose, 9) * shoulders_, source_bone(pose, 17, 16)) >
             40 * kRadians;
  }
  return 2 * apart > poses.size();
}

void Trunk::correct_ends(const BvhPose& pose, Rotations& world) const {
  if (pelvis_off_) {
    const Eigen::Vector3d hips = source_bone(pose, 2, 1);
    const Eigen::Vector3d middle = 0.5 * source_bone(pose, 1, 2);
    const Eigen::Vector3d lower =
        base_ < 0
            ? Eigen::Vector3d(0.5 * (source_bone(pose, 1, 16) + source_bone(pose, 1, 17)) - middle)
            : Eigen::Vector3d(source_bone(pose, 1, base_) - middle);
    world[0] = quaternion_from_matrix(frame(hips, lower) * frame(hips_, lower_).transpose());
  }
  if (!figure_.has(9)) world[9] = world[0];
  if (chest_off_) {
    const Eigen::Vector3d line = source_bone(pose, left_ + 1, left_);
    if (line.norm() > 1e-9)
      world[9] = (shortest_rotation(world[9] * shoulders_, line) * world[9]).normalized();
  }
}

void Trunk::fill_spine(Rotations& world) const {
  // A joint that has a source is where the sharing ends, or begins.
  if (!figure_.has(6)) world[6] = world[0].slerp(share_[1], world[9]);
  if (!figure_.has(3))
    world[3] = figure_.has(6) ? world[0].slerp(0.5, world[6]) : world[0].slerp(share_[0], world[9]);
}

Eigen::Vector3d Trunk::source_trunk(const BvhPose& pose) const {
  return 0.5 * (source_bone(pose, 0, 16) + source_bone(pose, 0, 17));
}

// Where SMPL's trunk should point: it leans against the pelvis as the source's does.
Eigen::Vector3d Trunk::wanted(const BvhPose& pose, const Rotations& world) const {
  const Eigen::Vector3d straight =
      world[0] * (0.5 * (rest_joint(16) + rest_joint(17)) - 0.5 * (rest_joint(1) + rest_joint(2)));
  return shortest_rotation(world[0] * trunk_, source_trunk(pose)) * straight;
}

void Trunk::keep_direction(const BvhPose& pose, Rotations& world) const {
  if (!keep_ || bend_[1] + bend_[2] == 0 || source_trunk(pose).norm() < 1e-9) return;
  const Eigen::Vector3d goal = wanted(pose, world), now = smpl_trunk(world);
  const double off = angle_between(now, goal);
  if (off < 1e-6 || now.cross(goal).norm() < 1e-9) return;
  const Eigen::Vector3d axis = now.cross(goal).normalized();
  const Rotations start = world;
  const auto left_after = [&](double turn) {  // what is left of `off`, below 0 beyond the goal
    for (const int joint : {0, 3, 6})
      world[joint_index(joint)] =
          (Eigen::Quaterniond(Eigen::AngleAxisd(bend_[joint_index(joint / 3)] * turn, axis)) *
           start[joint_index(joint)])
              .normalized();
    const Eigen::Vector3d reached = smpl_trunk(world);
    return std::atan2(reached.cross(goal).dot(axis), reached.dot(goal));
  };
  constexpr double kMost = 1.2;  // a trunk that would have to fold up is bent no further
  double before = 0, left_before = off, turn = std::min(2 * off, kMost);
  for (int round = 0; round < 8; ++round) {
    const double left = left_after(turn);
    if (std::abs(left) < 1e-6 || left == left_before) break;
    const double next = turn - left * (turn - before) / (left - left_before);
    before = turn;
    left_before = left;
    turn = std::clamp(next, 0.0, kMost);
    if (turn == before) break;
  }
}

}  // namespace mocaplm
