// Smooth random posture sequences for the tests.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "common/random.h"
#include "emulator/sequence.h"

namespace mocaplm {

// A motion of `limbs` limbs around fixed directions, moved by `modes` smooth modes with normal
// coefficients: in the tangent space it is a Gaussian process. `centre` other than 0 adds a motion
// of its own to all limbs, so that sequences of several centres are clusters.
inline PostureSequence random_motion(Eigen::Index limbs, Eigen::Index frames, Random& random,
                                     double scale = 0.15, double centre = 0) {
  Random directions(99);
  PostureSequence sequence;
  sequence.values.resize(3 * limbs, frames);
  constexpr int kModes = 3;
  double coefficients[kModes];
  for (double& c : coefficients) c = scale * random.normal();
  for (Eigen::Index i = 0; i < limbs; ++i) {
    Eigen::Vector3d base(directions.normal(), directions.normal(), directions.normal());
    base.normalize();
    const Eigen::Vector3d u = base.unitOrthogonal(), v = base.cross(u);
    double weights[kModes + 1][2];
    for (auto& pair : weights)
      for (double& weight : pair) weight = directions.normal();
    for (Eigen::Index t = 0; t < frames; ++t) {
      const double time = double(t) / double(std::max<Eigen::Index>(1, frames - 1));
      Eigen::Vector2d moved(0.3 * std::sin(3 * time) + centre * weights[kModes][0],
                            centre * weights[kModes][1] * time);
      for (int k = 0; k < kModes; ++k)
        for (int axis = 0; axis < 2; ++axis)
          moved[axis] += coefficients[k] * weights[k][axis] * std::cos(3.14159 * k * time);
      const Eigen::Vector3d at = base + moved[0] * u + moved[1] * v;
      sequence.values.block<3, 1>(3 * i, t) = at.normalized();
    }
  }
  return sequence;
}

inline std::vector<PostureSequence> random_motions(std::size_t count, Eigen::Index limbs,
                                                   Eigen::Index frames, std::uint64_t seed,
                                                   double scale = 0.15) {
  Random random(seed);
  std::vector<PostureSequence> all;
  for (std::size_t i = 0; i < count; ++i)
    all.push_back(random_motion(limbs, frames, random, scale));
  return all;
}

}  // namespace mocaplm
