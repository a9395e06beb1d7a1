// Geometry of the unit sphere S^2 in R^3: distance, exponential map and its inverse, parallel
// transport along the geodesic (Chen, Park, Srivastava, "Statistical Emulation of Human Operational
// Motions", section 3.1). Points y, z are unit vectors, tangent vectors v at y have y . v = 0, all
// lengths are radians.
//
// From a point to its antipode there are many geodesics. One is chosen, the same in both directions
// (sphere_direction), so that exponential map and transport there undo each other, too. Near the
// antipode (within 1e-7) log and transport are discontinuous by their nature.
#pragma once

#include <Eigen/Core>

namespace mocaplm {

// arccos(y . z) in [0, pi], computed so that it is exact for near and for opposite points.
double sphere_distance(const Eigen::Vector3d& y, const Eigen::Vector3d& z);

// A unit tangent vector at y, the same for y and -y: the axis that y is least along, made
// orthogonal to it.
Eigen::Vector3d sphere_direction(const Eigen::Vector3d& y);

// exp_y(v): the point reached from y along v after |v|; unit length again.
Eigen::Vector3d sphere_exp(const Eigen::Vector3d& y, const Eigen::Vector3d& v);
// The inverse: the v of length sphere_distance(y, z) with exp_y(v) = z. Zero where y = z; along
// sphere_direction(y) where z = -y.
Eigen::Vector3d sphere_log(const Eigen::Vector3d& y, const Eigen::Vector3d& z);

// The tangent vector v at y carried along the geodesic to z:
//   v - 2 (v . z) / |y + z|^2 (y + z)
// an isometry that keeps angles to the geodesic; v itself where y = z.
Eigen::Vector3d sphere_transport(const Eigen::Vector3d& v, const Eigen::Vector3d& y,
                                 const Eigen::Vector3d& z);

// Two orthonormal tangent vectors at y, as columns: the second is y x the first.
Eigen::Matrix<double, 3, 2> sphere_basis(const Eigen::Vector3d& y);

// The point of least sum of squared distances to the columns of `points` (3, m), m >= 1 (Karcher
// 1977), by gradient descent until the step is below 1e-12. Where the points have no unique mean
// (opposite points), one of them is found, always the same.
Eigen::Vector3d sphere_mean(const Eigen::Matrix3Xd& points);

}  // namespace mocaplm
