#include "motion/synth/body.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/synth/leg_ik.h"
#include "motion/synth/smooth.h"

namespace mocaplm {

namespace {

Eigen::Matrix3d turn(int axis, double angle) {
  return matrix_from_axis_angle(angle * Eigen::Vector3d::Unit(axis));
}

Eigen::Vector3d rest_offset(int joint, int parent) {
  return (rest_joints().row(joint) - rest_joints().row(parent)).transpose();
}

// Where everything below the waist is, a row a frame.
struct Base {
  Eigen::VectorXd heading;
  std::array<Translations, 2> ankles;
  std::vector<Eigen::Matrix3d> rotations;  // of the pelvis, world
  Translations pelvis;                     // position, world
};

void place_ankles(const Performance& p, Base& base) {
  for (std::size_t side = 0; side < 2; ++side) {
    const FootPath& foot = p.feet.feet[side];
    base.ankles[side].resize(foot.toe.rows(), 3);
    const Eigen::Vector3d back = toe_to_ankle(static_cast<int>(side));
    for (Eigen::Index t = 0; t < foot.toe.rows(); ++t) {
      const double pitch = foot.pitch(t) + p.torso[static_cast<std::size_t>(t)].heel;
      base.ankles[side].row(t) =
          foot.toe.row(t) + (foot_rotation(foot.yaw(t), pitch) * back).transpose();
    }
  }
}

// Over the feet, by the share of the weight that each carries.
void place_pelvis(const Performance& p, Base& base) {
  const Eigen::Index frames = base.ankles[0].rows();
  base.pelvis.resize(frames, 3);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const double left = p.feet.weight(t);
    base.pelvis.row(t) = left * base.ankles[0].row(t) + (1 - left) * base.ankles[1].row(t);
  }
  const std::vector<double> kernel = bell(0.12 * p.fps);
  for (int axis : {0, 2})
    base.pelvis.col(axis) = smoothed(Eigen::VectorXd(base.pelvis.col(axis)), kernel);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const TorsoPose& torso = p.torso[static_cast<std::size_t>(t)];
    const Eigen::Vector3d sway =
        turn(1, base.heading(t)) * Eigen::Vector3d(torso.sway_left, 0, 0.03 + torso.sway_front);
    base.pelvis.row(t) += sway.transpose();
    base.rotations.push_back(turn(1, base.heading(t) + torso.hip_twist) * turn(0, torso.hip_pitch) *
                             turn(2, torso.hip_roll));
  }
}

// As high as the dance wants, but never so high that a leg would be too short.
void lift_pelvis(const Performance& p, Base& base) {
  const double standing = kToeHeight + toe_to_ankle(0).y() + longest_leg(0) - rest_offset(1, 0).y();
  const Eigen::Index frames = base.pelvis.rows();
  Eigen::VectorXd wanted(frames), too_high(frames);
  for (Eigen::Index t = 0; t < frames; ++t) {
    wanted(t) = standing - p.torso[static_cast<std::size_t>(t)].down;
    double highest = wanted(t);
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector3d hip =
          base.rotations[static_cast<std::size_t>(t)] * rest_offset(1 + side, 0);
      const Eigen::Vector3d ankle = base.ankles[static_cast<std::size_t>(side)].row(t).transpose();
      const double x = base.pelvis(t, 0) + hip.x() - ankle.x(),
                   z = base.pelvis(t, 2) + hip.z() - ankle.z();
      const double up = std::sqrt(std::max(0.04, std::pow(longest_leg(side), 2) - x * x - z * z));
      highest = std::min(highest, ankle.y() + up - hip.y());
    }
    too_high(t) = wanted(t) - highest;
  }
  base.pelvis.col(1) = wanted - cover(too_high, bell(0.05 * p.fps));
}

void set_joint(Clip& clip, Eigen::Index t, int joint, const Eigen::Vector3d& rotation) {
  Eigen::Vector3d value = rotation;
  if (t > 0)
    value =
        continuous_axis_angle(rotation, clip.poses.block<1, 3>(t - 1, 3 * joint).transpose(), kPi);
  clip.poses.block<1, 3>(t, 3 * joint) = value.transpose();
}

void set_legs(Clip& clip, Eigen::Index t, const Performance& p, const Base& base) {
  const Eigen::Matrix3d& pelvis = base.rotations[static_cast<std::size_t>(t)];
  for (int side = 0; side < 2; ++side) {
    const FootPath& foot = p.feet.feet[static_cast<std::size_t>(side)];
    const Eigen::Vector3d hip = base.pelvis.row(t).transpose() + pelvis * rest_offset(1 + side, 0);
    const Eigen::Vector3d ankle = base.ankles[static_cast<std::size_t>(side)].row(t).transpose();
    // The knee points where the foot points, and a little where the pelvis does.
    const double knee_yaw = 0.7 * foot.yaw(t) + 0.3 * base.heading(t);
    const double pitch = foot.pitch(t) + p.torso[static_cast<std::size_t>(t)].heel;
    const LegRotations leg = solve_leg(side, hip, ankle, pelvis, foot_rotation(foot.yaw(t), pitch),
                                       turn(1, knee_yaw) * Eigen::Vector3d::UnitX());
    set_joint(clip, t, 1 + side, leg.hip);
    set_joint(clip, t, 4 + side, leg.knee);
    set_joint(clip, t, 7 + side, leg.ankle);
  }
}

// The chest's turn in three equal parts; the lowest also takes back most of what the hips do, so
// that a dancer moves the hips under a quiet chest.
void set_spine(Clip& clip, Eigen::Index t, const TorsoPose& torso) {
  const Eigen::Matrix3d part =
      turn(1, torso.twist / 3) * turn(0, torso.pitch / 3) * turn(2, torso.roll / 3);
  const Eigen::Matrix3d back = turn(2, -0.7 * torso.hip_roll) * turn(0, -0.7 * torso.hip_pitch) *
                               turn(1, -0.7 * torso.hip_twist);
  set_joint(clip, t, 3, axis_angle_from_matrix(back * part));
  for (int joint : {6, 9}) set_joint(clip, t, joint, axis_angle_from_matrix(part));
  const Eigen::Matrix3d head = turn(1, torso.look / 2) * turn(0, torso.nod / 2);
  for (int joint : {12, 15}) set_joint(clip, t, joint, axis_angle_from_matrix(head));
}

void set_arm(Clip& clip, Eigen::Index t, int side, ArmPose pose) {
  // The collar bone goes up with the arm and takes its share of the raise.
  const double collar = 0.15 * (std::min(pose.raise, 1.5) + 1.2);
  pose.raise -= collar;
  const std::array<Eigen::Vector3d, 3> arm = arm_rotations(pose, side);
  set_joint(clip, t, 13 + side, (side == 0 ? collar : -collar) * Eigen::Vector3d::UnitZ());
  for (int k = 0; k < 3; ++k)
    set_joint(clip, t, 16 + 2 * k + side, arm[static_cast<std::size_t>(k)]);
}

}  // namespace

Clip embody(const Performance& p) {
  Base base;
  base.heading = smoothed(p.feet.heading, bell(0.1 * p.fps));
  place_ankles(p, base);
  place_pelvis(p, base);
  lift_pelvis(p, base);

  const Eigen::Index frames = base.pelvis.rows();
  Clip clip;
  clip.fps = p.fps;
  clip.poses.setZero(frames, 72);
  clip.trans = base.pelvis.rowwise() - rest_joints().row(0);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const std::size_t at = static_cast<std::size_t>(t);
    set_joint(clip, t, 0, axis_angle_from_matrix(base.rotations[at]));
    set_legs(clip, t, p, base);
    set_spine(clip, t, p.torso[at]);
    for (std::size_t side = 0; side < 2; ++side)
      set_arm(clip, t, static_cast<int>(side), p.arms[side][at]);
  }
  return clip;
}

}  // namespace mocaplm
