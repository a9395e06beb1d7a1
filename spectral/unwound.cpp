#include "spectral/unwound.h"

#include "common/angles.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr double kManyTurns = 64 * kPi;

// Rewrites the first frame's rotation vectors, each by change(joint, vector), and lets the others
// follow.
template <class Change>
Clip follow(const Clip& clip, double limit, const Change& change) {
  Clip out = clip;
  for (int j = 0; j < kJoints; ++j) {
    auto cell = out.poses.row(0).segment<3>(3 * j);
    cell = change(j, Eigen::Vector3d(cell.transpose())).transpose();
  }
  keep_continuous(out, limit);
  return out;
}

Eigen::Vector3d shortest(int, const Eigen::Vector3d& vector) {
  return axis_angle_from_quaternion(quaternion_from_axis_angle(vector));
}

}  // namespace

Clip unwound(const Clip& clip) {
  return follow(clip, kManyTurns, shortest);
}

Clip unwound_beside(const Clip& clip, const Clip& beside) {
  return follow(clip, kManyTurns, [&](int j, const Eigen::Vector3d& vector) {
    return continuous_axis_angle(vector, beside.poses.row(0).segment<3>(3 * j).transpose(),
                                 kManyTurns);
  });
}

Clip wound(const Clip& clip) {
  return follow(clip, kPi, shortest);
}

}  // namespace mocaplm
