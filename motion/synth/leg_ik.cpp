#include "motion/synth/leg_ik.h"

#include <algorithm>
#include <cmath>

#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

constexpr double kStraightest =
    0.10;  // radians of knee bend; a locked knee would snap on its way back
constexpr double kSharpest = 2.5;

struct Bones {
  Eigen::Vector3d thigh, shin;  // in the rest pose, metres
};

Bones bones_of(int side) {
  const RestJoints& rest = rest_joints();
  const int hip = 1 + side, knee = 4 + side, ankle = 7 + side;
  return {(rest.row(knee) - rest.row(hip)).transpose(),
          (rest.row(ankle) - rest.row(knee)).transpose()};
}

Eigen::Matrix3d bend_knee(double angle) {
  return matrix_from_axis_angle(angle * Eigen::Vector3d::UnitX());
}

// |thigh + R_x(a) shin|^2 = c + 2 r cos(a - phi): solved for the bend `a` that gives `distance`.
double bend_for(const Bones& bones, double distance) {
  const Eigen::Vector3d &u = bones.thigh, &v = bones.shin;
  const double cosine = u.y() * v.y() + u.z() * v.z(), sine = u.z() * v.y() - u.y() * v.z();
  const double r = std::hypot(cosine, sine), phi = std::atan2(sine, cosine);
  const double c = u.squaredNorm() + v.squaredNorm() + 2 * u.x() * v.x();
  const double wanted = std::clamp((distance * distance - c) / (2 * r), -1.0, 1.0);
  return std::clamp(phi + std::acos(wanted), kStraightest, kSharpest);
}

}  // namespace

double longest_leg(int side) {
  const Bones bones = bones_of(side);
  return (bones.thigh + bend_knee(kStraightest) * bones.shin).norm();
}

LegRotations solve_leg(int side, const Eigen::Vector3d& hip, const Eigen::Vector3d& ankle,
                       const Eigen::Matrix3d& pelvis, const Eigen::Matrix3d& foot,
                       const Eigen::Vector3d& across) {
  const Bones bones = bones_of(side);
  const Eigen::Vector3d way = ankle - hip;
  const double angle = bend_for(bones, way.norm());
  const Eigen::Matrix3d knee = bend_knee(angle);
  const Eigen::Vector3d leg = bones.thigh + knee * bones.shin;
  const Eigen::Matrix3d thigh =
      frame_along(way, across) * frame_along(leg, Eigen::Vector3d::UnitX()).transpose();
  LegRotations solved;
  solved.hip = axis_angle_from_matrix(pelvis.transpose() * thigh);
  solved.knee = angle * Eigen::Vector3d::UnitX();
  solved.ankle = axis_angle_from_matrix((thigh * knee).transpose() * foot);
  solved.short_of = (way - thigh * leg).norm();
  return solved;
}

}  // namespace mocaplm
