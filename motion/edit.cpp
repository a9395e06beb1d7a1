#include "motion/edit.h"

#include <cmath>

#include "motion/floor.h"
#include "motion/mirror.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/turn.h"

namespace mocaplm {

namespace {

// Where it began, facing +Z.
Clip faced(const Clip& clip) {
  Clip out = turned(clip, -facing(clip, 0));
  const Eigen::RowVector3d moved = out.trans.row(0) - clip.trans.row(0);
  out.trans.rowwise() -= moved;
  return out;
}

}  // namespace

double facing(const Clip& clip, Eigen::Index frame) {
  const Eigen::Vector3d pelvis = clip.poses.row(frame).head<3>().transpose();
  const Eigen::Vector3d front = matrix_from_axis_angle(pelvis).col(2);
  return std::hypot(front.x(), front.z()) < 1e-6 ? 0 : std::atan2(front.x(), front.z());
}

Clip edited(const Clip& clip, const EditConfig& config) {
  Clip out = config.fps > 0 ? resample(clip, config.fps) : clip;
  if (config.mirror) out = mirror(out);
  if (config.face) out = faced(out);
  if (config.floor) stand_on_ground(out);
  return out;
}

}  // namespace mocaplm
