#include "evaluate/generated/forecast_windows.h"

#include <algorithm>
#include <cmath>

#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

Eigen::Quaterniond rotation(const Clip& clip, Eigen::Index frame, int joint) {
  return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * joint).transpose());
}

}  // namespace

std::vector<ForecastWindow> forecast_windows(const Clip& clip, Eigen::Index seed,
                                             Eigen::Index ahead) {
  const auto second = static_cast<Eigen::Index>(std::llround(clip.fps));
  const Eigen::Index length = seed + std::max(ahead, second);
  std::vector<ForecastWindow> windows;
  for (Eigen::Index first = 0; first + length <= clip.frames(); first += seed)
    windows.push_back({slice(clip, first, seed), slice(clip, first + seed, ahead)});
  return windows;
}

Clip zero_velocity(const Clip& seed, Eigen::Index frames) {
  Clip clip = slice(seed, seed.frames() - 1, 1);
  clip.poses = Poses(clip.poses.replicate(frames, 1));
  clip.trans = Translations(clip.trans.replicate(frames, 1));
  return clip;
}

Clip linear_extrapolation(const Clip& seed, Eigen::Index frames) {
  Clip clip = zero_velocity(seed, frames);
  const Eigen::Index last = seed.frames() - 1;
  if (last == 0) return clip;
  const Eigen::RowVector3d step = seed.trans.row(last) - seed.trans.row(last - 1);
  for (int j = 0; j < kJoints; ++j) {
    const Eigen::Quaterniond end = rotation(seed, last, j);
    const Eigen::Vector3d turn =
        axis_angle_from_quaternion(rotation(seed, last - 1, j).conjugate() * end);
    for (Eigen::Index t = 0; t < frames; ++t)
      clip.poses.row(t).segment<3>(3 * j) =
          axis_angle_from_quaternion(end *
                                     quaternion_from_axis_angle(static_cast<double>(t + 1) * turn))
              .transpose();
  }
  for (Eigen::Index t = 0; t < frames; ++t) clip.trans.row(t) += static_cast<double>(t + 1) * step;
  return clip;
}

}  // namespace mocaplm
