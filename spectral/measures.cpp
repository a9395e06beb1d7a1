#include "spectral/measures.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <vector>

#include "common/angles.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "spectral/frequencies.h"
#include "spectral/unwound.h"

namespace mocaplm {

namespace {

constexpr double kStill = 1e-20;  // squared radians: rounding, no movement

}  // namespace

double roughness(const Clip& clip) {
  if (clip.frames() < 4) return 0;
  std::vector<JointPositions> positions;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    JointPositions frame = joint_positions(clip, t);
    frame.rowwise() -= frame.row(0).eval();
    positions.push_back(frame);
  }
  double sum = 0;
  for (std::size_t t = 3; t < positions.size(); ++t)
    sum += (positions[t] - 3 * positions[t - 1] + 3 * positions[t - 2] - positions[t - 3])
               .rowwise()
               .norm()
               .sum();
  const auto count = static_cast<double>((clip.frames() - 3) * (kJoints - 1));
  return sum / count * clip.fps * clip.fps * clip.fps;
}

double fast_share(const Clip& clip, double hertz) {
  const Clip smooth = unwound(clip);
  const Eigen::Index n = smooth.frames();
  const Eigen::MatrixXd moving = smooth.poses.rowwise() - smooth.poses.colwise().mean();
  const double all = moving.squaredNorm();
  if (all < kStill) return 0;
  const RowRange fast =
      rows_within(hertz, std::numeric_limits<double>::infinity(), dct_step(smooth.fps, n), n);
  double slow = 0;
  visit_dct_rows(n, {1, fast.first}, [&](Eigen::Index, const Eigen::MatrixXd& basis) {
    slow += (basis * moving).squaredNorm();
  });
  return std::clamp(1 - slow / all, 0.0, 1.0);
}

AngleApart angle_apart(const Clip& a, const Clip& b) {
  assert(a.frames() == b.frames());
  AngleApart apart;
  for (Eigen::Index t = 0; t < a.frames(); ++t)
    for (int j = 0; j < kJoints; ++j) {
      const auto quaternion = [&](const Clip& clip) {
        return quaternion_from_axis_angle(clip.poses.row(t).segment<3>(3 * j).transpose());
      };
      const double degrees = geodesic_angle(quaternion(a), quaternion(b)) * 180 / kPi;
      apart.mean += degrees / static_cast<double>(a.frames() * kJoints);
      apart.most = std::max(apart.most, degrees);
    }
  return apart;
}

}  // namespace mocaplm
