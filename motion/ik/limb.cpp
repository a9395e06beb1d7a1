#include "motion/ik/limb.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/rotation.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

// Radians between the bones: below the first the plane counts nothing, above the second all.
constexpr double kStraight = 0.14, kBent = 0.45;
constexpr double kFolded = 0.5;     // radians short of folded flat, where the plane is noise again
constexpr double kNeutral = 0.003;  // weight of the shortest way from the rest pose
constexpr double kSeconds = 0.03;   // over which the turn of a bent limb is smoothed

// The lower bone in the rest pose's frame after bending about the hinge until it makes the angle
// `bend` with the upper one; the nearest that can be reached.
Eigen::Vector3d bent_lower(const LimbRest& rest, double bend) {
  const Eigen::Vector3d &u = rest.hinge, &a = rest.upper, &b = rest.lower;
  const double along = a.dot(u) * b.dot(u);
  const double cosine = a.dot(b) - along, sine = a.dot(u.cross(b));
  const double reach = std::hypot(cosine, sine), phase = std::atan2(sine, cosine);
  const double wanted = std::clamp((std::cos(bend) - along) / reach, -1.0, 1.0);
  return Eigen::AngleAxisd(phase + std::acos(wanted), u) * b;
}

// The angle about `axis` that turns `from` into `to`, both rotations that bring `rest` to `axis`.
double turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to,
                    const Eigen::Vector3d& rest, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d across = rest.unitOrthogonal();
  const Eigen::Vector3d a = from * across, b = to * across;
  return std::atan2(axis.dot(a.cross(b)), a.dot(b));
}

// The x that makes sum_t weight_t (x_t - value_t)^2 + tie (x_t - x_(t-1))^2 least: a tridiagonal
// system, solved in place.
std::vector<double> smooth(const std::vector<double>& value, const std::vector<double>& weight,
                           double tie) {
  const std::size_t n = value.size();
  std::vector<double> ratio(n), x(n);
  for (std::size_t t = 0; t < n; ++t) {
    const double before = t > 0 ? tie : 0, after = t + 1 < n ? tie : 0;
    const double pivot = weight[t] + before + after - (t > 0 ? before * ratio[t - 1] : 0);
    ratio[t] = after / pivot;
    x[t] = (weight[t] * value[t] + (t > 0 ? before * x[t - 1] : 0)) / pivot;
  }
  for (std::size_t t = n - 1; t-- > 0;) x[t] += ratio[t] * x[t + 1];
  return x;
}

}  // namespace

Eigen::Quaterniond frame_rotation(const Eigen::Vector3d& first, const Eigen::Vector3d& second,
                                  const Eigen::Vector3d& to_first,
                                  const Eigen::Vector3d& to_second) {
  return Eigen::Quaterniond(frame_along(to_first, to_second) *
                            frame_along(first, second).transpose());
}

std::vector<Eigen::Quaterniond> limb_rotations(const LimbRest& rest,
                                               const std::vector<Eigen::Vector3d>& upper,
                                               const std::vector<Eigen::Vector3d>& lower,
                                               double fps) {
  const std::size_t frames = upper.size();
  // Carried along with the bone without a turn about it; the turn is an angle beyond that.
  std::vector<Eigen::Quaterniond> carried(frames);
  std::vector<double> value(frames), weight(frames);
  double last = 0;
  for (std::size_t t = 0; t < frames; ++t) {
    const Eigen::Quaterniond neutral = shortest_rotation(rest.upper, upper[t]);
    carried[t] = t == 0 ? neutral
                        : (shortest_rotation(upper[t - 1], upper[t]) * carried[t - 1]).normalized();
    const double bend = angle_between(upper[t], lower[t]);
    const double straightness = std::clamp((bend - kStraight) / (kBent - kStraight), 0.0, 1.0);
    // Folded flat on itself a limb has no plane either.
    const double hinge_weight = straightness * straightness * (3 - 2 * straightness) *
                                std::min(1.0, (kPi - bend) / kFolded);
    const double to_neutral =
        nearest_turn(turn_between(carried[t], neutral, rest.upper, upper[t]), last);
    value[t] = kNeutral * to_neutral;
    weight[t] = kNeutral;
    if (hinge_weight > 0) {
      const Eigen::Quaterniond hinged =
          frame_rotation(rest.upper, bent_lower(rest, bend), upper[t], lower[t]);
      const double to_hinge =
          nearest_turn(turn_between(carried[t], hinged, rest.upper, upper[t]), last);
      value[t] += hinge_weight * to_hinge;
      weight[t] += hinge_weight;
    }
    value[t] /= weight[t];
    // What the next frame's angle is counted from: slowly where this one hardly knows.
    last += (t == 0 ? 1.0 : std::min(1.0, weight[t])) * (value[t] - last);
  }
  const double reach = kSeconds * fps;
  const std::vector<double> turn = smooth(value, weight, reach * reach);
  std::vector<Eigen::Quaterniond> rotations(frames);
  for (std::size_t t = 0; t < frames; ++t) {
    const Eigen::Quaterniond turned = Eigen::AngleAxisd(turn[t], upper[t]) * carried[t];
    // Rounding of many frames must not cost the bone its direction.
    rotations[t] = (shortest_rotation(turned * rest.upper, upper[t]) * turned).normalized();
  }
  return rotations;
}

}  // namespace mocaplm
