// Random postures and sequences for tests.
#pragma once

#include <cmath>

#include "common/angles.h"
#include "common/random.h"
#include "emulator/sequence.h"
#include "emulator/sphere.h"

namespace mocaplm {

inline Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

inline Posture random_posture(Random& random, Eigen::Index limbs) {
  Posture posture(3, limbs);
  for (Eigen::Index i = 0; i < limbs; ++i) posture.col(i) = random_direction(random);
  return posture;
}

inline Eigen::Vector3d random_tangent(Random& random, const Eigen::Vector3d& y, double length) {
  const Eigen::Vector3d v = random_direction(random);
  return (v - v.dot(y) * y).normalized() * length;
}

// Smooth: each limb swings around a direction of its own by a few sines, up to `swing` radians.
inline PostureSequence random_sequence(Random& random, Eigen::Index limbs, Eigen::Index frames,
                                       double swing = 0.6) {
  const Posture centre = random_posture(random, limbs);
  PostureSequence sequence;
  sequence.values.resize(3 * limbs, frames);
  for (Eigen::Index i = 0; i < limbs; ++i) {
    const auto basis = sphere_basis(centre.col(i));
    double waves[2][3][2];
    for (auto& axis : waves)
      for (auto& wave : axis) {
        wave[0] = random.uniform(-swing, swing) / 3;
        wave[1] = random.uniform(0, 2 * kPi);
      }
    for (Eigen::Index t = 0; t < frames; ++t) {
      const double time =
          static_cast<double>(t) / static_cast<double>(std::max<Eigen::Index>(frames - 1, 1));
      Eigen::Vector2d at = Eigen::Vector2d::Zero();
      for (int a = 0; a < 2; ++a)
        for (int k = 0; k < 3; ++k)
          at[a] += waves[a][k][0] * std::sin((k + 1) * kPi * time + waves[a][k][1]);
      sequence.at(t).col(i) = sphere_exp(centre.col(i), basis * at);
    }
  }
  return sequence;
}

}  // namespace mocaplm
