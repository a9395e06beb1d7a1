#include "motion/turn.h"

#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

Clip turned(const Clip& clip, double angle) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  const Eigen::Vector3d rest = rest_joints().row(0).transpose();
  Clip out = clip;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    auto pelvis = out.poses.row(t).head<3>();
    pelvis = axis_angle_from_quaternion(turn * quaternion_from_axis_angle(pelvis.transpose()))
                 .transpose();
    // The pelvis lies at trans + rest.
    const Eigen::Vector3d at = clip.trans.row(t).transpose() + rest;
    out.trans.row(t) = (turn * at - rest).transpose();
  }
  return out;
}

}  // namespace mocaplm
