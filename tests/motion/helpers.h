// Random clips for the motion tests.
#pragma once

#include <Eigen/Geometry>

#include "common/random.h"
#include "motion/clip.h"

namespace mocaplm {

inline Eigen::Vector3d random_direction(Random& random) {
  Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
  return v.normalized();
}

// Every frame is unrelated to the one before.
inline Clip random_clip(Random& random, Eigen::Index frames, double fps, double max_angle = 3.0) {
  Clip clip;
  clip.name = "random";
  clip.fps = fps;
  clip.poses.resize(frames, 72);
  clip.trans.resize(frames, 3);
  for (Eigen::Index t = 0; t < frames; ++t) {
    for (int j = 0; j < 24; ++j)
      clip.poses.row(t).segment<3>(3 * j) =
          random.uniform(0, max_angle) * random_direction(random).transpose();
    for (int c = 0; c < 3; ++c) clip.trans(t, c) = random.uniform(-2, 2);
  }
  return clip;
}

}  // namespace mocaplm
