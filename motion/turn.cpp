#include "motion/turn.h"

#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

void turn_all(Clip& clip, const Eigen::Quaterniond& turn) {
  const Eigen::Vector3d rest = rest_joints(clip).row(0).transpose();
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    auto pelvis = clip.poses.row(t).head<3>();
    pelvis = axis_angle_from_quaternion(turn * quaternion_from_axis_angle(pelvis.transpose()))
                 .transpose();
    const Eigen::Vector3d at = clip.trans.row(t).transpose() + rest;
    clip.trans.row(t) = (turn * at - rest).transpose();
  }
}

}  // namespace

Clip turned(const Clip& clip, double angle) {
  Clip out = clip;
  turn_all(out, Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())));
  return out;
}

void turn_world(Clip& clip, const Eigen::Matrix3d& turn) {
  turn_all(clip, quaternion_from_matrix(turn));
}

}  // namespace mocaplm
