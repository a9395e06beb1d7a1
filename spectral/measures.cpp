#include "spectral/measures.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "numeric/dct.h"

namespace mocaplm {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kManyTurns = 64 * kPi;
constexpr Eigen::Index kRowsAtOnce = 256;

void shorten_first_frame(Clip& clip) {
  for (int j = 0; j < kJoints; ++j) {
    auto cell = clip.poses.row(0).segment<3>(3 * j);
    cell = axis_angle_from_quaternion(quaternion_from_axis_angle(cell.transpose())).transpose();
  }
}

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
  if (all < 1e-20) return 0;
  const double step = smooth.fps / (2 * static_cast<double>(n));
  const auto slow = std::min(n, static_cast<Eigen::Index>(std::ceil(hertz / step)));
  double kept = 0;
  for (Eigen::Index first = 1; first < slow; first += kRowsAtOnce)
    kept += (dct_rows(n, first, std::min(kRowsAtOnce, slow - first)) * moving).squaredNorm();
  return std::clamp(1 - kept / all, 0.0, 1.0);
}

Clip unwound(const Clip& clip) {
  Clip out = clip;
  shorten_first_frame(out);
  keep_continuous(out, kManyTurns);
  return out;
}

Clip wound(const Clip& clip) {
  Clip out = clip;
  shorten_first_frame(out);
  keep_continuous(out, kPi);
  return out;
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
