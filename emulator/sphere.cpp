#include "emulator/sphere.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/angles.h"

namespace mocaplm {

namespace {

// Sine of the angle to the antipode below which two points count as opposite.
constexpr double kOpposite = 1e-12;

}  // namespace

double sphere_distance(const Eigen::Vector3d& y, const Eigen::Vector3d& z) {
  return std::atan2(y.cross(z).norm(), y.dot(z));
}

Eigen::Vector3d sphere_direction(const Eigen::Vector3d& y) {
  Eigen::Index least = 0;
  y.cwiseAbs().minCoeff(&least);
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(least);
  return (axis - y.dot(axis) * y).normalized();
}

Eigen::Vector3d sphere_exp(const Eigen::Vector3d& y, const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle < 1e-8) return (y + v).normalized();
  return (std::cos(angle) * y + std::sin(angle) / angle * v).normalized();
}

Eigen::Vector3d sphere_log(const Eigen::Vector3d& y, const Eigen::Vector3d& z) {
  const double cosine = y.dot(z);
  const Eigen::Vector3d across = z - cosine * y;
  const double sine = across.norm();
  if (cosine < 0 && sine < kOpposite) return kPi * sphere_direction(y);
  return sine == 0 ? across : Eigen::Vector3d(std::atan2(sine, cosine) / sine * across);
}

Eigen::Vector3d sphere_transport(const Eigen::Vector3d& v, const Eigen::Vector3d& y,
                                 const Eigen::Vector3d& z) {
  // Both are reflections, so lengths are kept to the last bit that counts.
  Eigen::Vector3d normal = y + z;
  if (normal.norm() < kOpposite) normal = sphere_direction(y);
  return v - 2 * v.dot(normal) / normal.squaredNorm() * normal;
}

Eigen::Matrix<double, 3, 2> sphere_basis(const Eigen::Vector3d& y) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = sphere_direction(y);
  basis.col(1) = y.cross(basis.col(0));
  return basis;
}

Eigen::Vector3d sphere_mean(const Eigen::Matrix3Xd& points) {
  Eigen::Vector3d mean = points.rowwise().mean();
  // Points that cancel have no nearest one to begin with.
  mean = mean.norm() < 1e-9 ? sphere_direction(points.col(0)) : mean.normalized();
  double last = 4, pace = 1;
  for (int round = 0; round < 200; ++round) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < points.cols(); ++i) step += sphere_log(mean, points.col(i));
    step /= static_cast<double>(points.cols());
    const double length = step.norm();
    if (length < 1e-12) break;
    if (length >= last) pace = std::max(pace / 2, 1e-3);
    last = length;
    mean = sphere_exp(mean, pace * step);
  }
  return mean;
}

}  // namespace mocaplm
