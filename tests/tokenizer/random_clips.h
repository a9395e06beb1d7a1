// Smooth random motion for the tests: a dancer who walks, turns and bends at random.
#pragma once

#include <cmath>
#include <string>

#include "common/random.h"
#include "motion/clip.h"
#include "motion/rotation.h"

namespace mocaplm {

// Every joint's rotation vector is the shortest one of a product of small random turns.
inline Clip random_clip(std::uint64_t seed, Eigen::Index frames, double fps = 20,
                        const std::string& name = "random") {
  Random random(seed);
  Clip clip;
  clip.name = name;
  clip.fps = fps;
  clip.poses.resize(frames, 72);
  clip.trans.resize(frames, 3);
  const auto vector = [&](double scale) -> Eigen::Vector3d {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return scale * Eigen::Vector3d(x, y, z);
  };
  for (int j = 0; j < 24; ++j) {
    Eigen::Quaterniond q = quaternion_from_axis_angle(vector(j == 0 ? 1.5 : 0.4));
    Eigen::Vector3d speed = vector(0.05);
    for (Eigen::Index t = 0; t < frames; ++t) {
      clip.poses.row(t).segment<3>(3 * j) = axis_angle_from_quaternion(q).transpose();
      speed = 0.9 * speed + vector(0.02);
      q = (q * quaternion_from_axis_angle(speed)).normalized();
    }
  }
  Eigen::Vector3d position = vector(1), speed = vector(0.02);
  for (Eigen::Index t = 0; t < frames; ++t) {
    clip.trans.row(t) = position.transpose();
    speed = 0.9 * speed + vector(0.01);
    position += speed;
    position.y() *= 0.98;
  }
  return clip;
}

}  // namespace mocaplm
