// Rotations: axis-angle (rotation vectors, radians), unit quaternions (w, x, y, z), matrices,
// Euler. Every conversion is stable near angle 0 (series) and near pi (largest component).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace mocaplm {

Eigen::Quaterniond quaternion_from_axis_angle(const Eigen::Vector3d& axis_angle);
// The shortest rotation vector: its norm is in [0, pi].
Eigen::Vector3d axis_angle_from_quaternion(const Eigen::Quaterniond& quaternion);
Eigen::Matrix3d matrix_from_axis_angle(const Eigen::Vector3d& axis_angle);
Eigen::Vector3d axis_angle_from_matrix(const Eigen::Matrix3d& matrix);
// The nearest unit quaternion of a rotation matrix.
Eigen::Quaterniond quaternion_from_matrix(const Eigen::Matrix3d& matrix);

// Axes in the order in which they are written: {2, 0, 1} is ZXY, R = R_z(a0) R_x(a1) R_y(a2),
// radians.
using EulerOrder = std::array<int, 3>;
inline constexpr EulerOrder kZxy = {2, 0, 1};
Eigen::Matrix3d matrix_from_euler(const Eigen::Vector3d& angles, const EulerOrder& order);
// Middle angle in [-pi/2, pi/2], the others in (-pi, pi]; at the gimbal lock the third angle is 0.
// `order` must name three different axes.
Eigen::Vector3d euler_from_matrix(const Eigen::Matrix3d& matrix, const EulerOrder& order);

// Angle of the smallest rotation between two, radians in [0, pi].
double geodesic_angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);
// The shortest rotation that turns `from` into the direction of `to` (both non-zero).
Eigen::Quaterniond shortest_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// The rotation vector of the same rotation (v + 2 pi k v/|v|) nearest to `previous` among those
// whose components all lie in [-limit, limit]; `axis_angle` itself, made shortest, when no other
// one fits.
Eigen::Vector3d continuous_axis_angle(const Eigen::Vector3d& axis_angle,
                                      const Eigen::Vector3d& previous, double limit);

}  // namespace mocaplm
