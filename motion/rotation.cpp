#include "motion/rotation.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/taylor.h"

namespace mocaplm {

namespace {

double wrap(double angle) {
  const double wrapped = std::remainder(angle, kTurn);
  return wrapped == -kPi ? kPi : wrapped;
}

// +1 for the cyclic orders XYZ, YZX, ZXY, else -1.
double parity(const EulerOrder& order) {
  return (order[1] - order[0] + 3) % 3 == 1 ? 1 : -1;
}

}  // namespace

Eigen::Quaterniond quaternion_from_axis_angle(const Eigen::Vector3d& v) {
  const double z = 0.25 * v.squaredNorm();  // half the angle, squared
  double cosine, sinc;
  if (z <= 2.4674) {  // rotations of at most half a turn: Taylor series, to the last bit
    cosine = series<11>(kCosine, z);
    sinc = series<11>(kSinc, z);
  } else {
    const double half = std::sqrt(z);
    cosine = std::cos(half);
    sinc = std::sin(half) / half;
  }
  const Eigen::Vector3d imaginary = 0.5 * sinc * v;
  return Eigen::Quaterniond(cosine, imaginary.x(), imaginary.y(), imaginary.z());
}

Eigen::Vector3d axis_angle_from_quaternion(const Eigen::Quaterniond& q) {
  // Of a quaternion of any length: only the ratio of its parts counts.
  const double w = std::abs(q.w()), sine = q.vec().norm();
  // angle / sin(angle / 2); atan2 keeps full precision at both ends.
  const double scale = sine < 1e-8 * w ? 2 / w : 2 * std::atan2(sine, w) / sine;
  return (q.w() < 0 ? -scale : scale) * q.vec();
}

Eigen::Matrix3d matrix_from_axis_angle(const Eigen::Vector3d& v) {
  return quaternion_from_axis_angle(v).toRotationMatrix();
}

Eigen::Quaterniond quaternion_from_matrix(const Eigen::Matrix3d& matrix) {
  // Eigen takes the largest of w, x, y, z as the pivot, which is what keeps it stable near pi.
  return Eigen::Quaterniond(matrix).normalized();
}

Eigen::Vector3d axis_angle_from_matrix(const Eigen::Matrix3d& matrix) {
  return axis_angle_from_quaternion(quaternion_from_matrix(matrix));
}

Eigen::Matrix3d matrix_from_euler(const Eigen::Vector3d& angles, const EulerOrder& order) {
  Eigen::Matrix3d all = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i)
    all = all *
          Eigen::AngleAxisd(angles[i], Eigen::Vector3d::Unit(order[static_cast<std::size_t>(i)]))
              .toRotationMatrix();
  return all;
}

Eigen::Vector3d euler_from_matrix(const Eigen::Matrix3d& m, const EulerOrder& order) {
  const int i = order[0], j = order[1], k = order[2];
  const double s = parity(order);
  const double cosine = std::hypot(m(i, i), m(i, j));
  // atan2 with the cosine keeps the middle angle precise near +-pi/2 where asin is not.
  const double middle = std::atan2(s * m(i, k), cosine);
  if (cosine < 1e-12)  // gimbal lock: only the sum or difference of the outer angles is defined
    return {wrap(std::atan2(s * m(k, j), m(j, j))), middle, 0};
  const double first = std::atan2(-s * m(j, k), m(k, k));
  // With the first rotation taken off, row j is the third rotation's alone. Read from there, the
  // third angle makes up for what the first one lost near the gimbal lock.
  const double c = std::cos(first), sine = s * std::sin(first);
  const double third = std::atan2(s * (c * m(j, i) + sine * m(k, i)), c * m(j, j) + sine * m(k, j));
  return {wrap(first), middle, wrap(third)};
}

double geodesic_angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond difference = a.conjugate() * b;
  return 2 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
}

Eigen::Quaterniond shortest_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const double dot = from.dot(to);
  if (dot >= 0) {  // (|from| |to| + from . to, from x to) lies along the quaternion
    const Eigen::Vector3d normal = from.cross(to);
    const double w = std::sqrt(from.squaredNorm() * to.squaredNorm()) + dot;
    return Eigen::Quaterniond(w, normal.x(), normal.y(), normal.z()).normalized();
  }
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  // The half angle from |a + b| and |a - b|, which do not cancel where a . b nears -1.
  const double cosine = 0.5 * (a + b).norm();
  Eigen::Vector3d axis = a.cross(b);
  const Eigen::Vector3d apart = (a - b).normalized();
  if (axis.norm() < 1e-12) axis = apart.unitOrthogonal();  // opposite: any half turn does
  axis -= axis.dot(apart) * apart;                         // rounding must not tilt it towards them
  const Eigen::Vector3d imaginary = 0.5 * (a - b).norm() * axis.normalized();
  return Eigen::Quaterniond(cosine, imaginary.x(), imaginary.y(), imaginary.z()).normalized();
}

Eigen::Vector3d continuous_axis_angle(const Eigen::Vector3d& axis_angle,
                                      const Eigen::Vector3d& previous, double limit) {
  const Eigen::Vector3d shortest =
      axis_angle_from_quaternion(quaternion_from_axis_angle(axis_angle));
  const double angle = shortest.norm();
  // At no rotation every axis is as good: a whole turn about the previous one may be the
  // continuation.
  const Eigen::Vector3d axis = angle > 1e-9             ? Eigen::Vector3d(shortest / angle)
                               : previous.norm() > 1e-9 ? Eigen::Vector3d(previous.normalized())
                                                        : Eigen::Vector3d::UnitX();
  Eigen::Vector3d best = shortest;
  double best_distance = (shortest - previous).squaredNorm();
  const int turns = static_cast<int>(std::ceil(limit * std::sqrt(3.0) / kTurn)) + 1;
  for (int k = -turns; k <= turns; ++k) {
    const Eigen::Vector3d candidate = (angle + kTurn * k) * axis;
    if (candidate.cwiseAbs().maxCoeff() > limit) continue;
    const double distance = (candidate - previous).squaredNorm();
    if (distance < best_distance - 1e-12) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace mocaplm
