#include "motion/synth/arms.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/rotation.h"
#include "motion/synth/beat.h"

namespace mocaplm {

namespace {

// Where the way between the two ends stands, 0 to 1, after `u` cycles.
double progress(Curve curve, double u, double attack) {
  switch (curve) {
    case Curve::hit:
      return hit_curve(u, attack);
    case Curve::pulse:
      return pulse_curve(u, attack);
    case Curve::reach:
      return reach_curve(u);
    default:
      return swing_curve(u);
  }
}

// A wave runs outwards: each joint does the same a little after the one before.
ArmPose wave(const ArmFigure& figure, double u) {
  const double lag = 0.14;
  const auto between = [](double a, double b, double s) { return a + s * (b - a); };
  ArmPose pose;
  pose.raise = between(figure.from.raise, figure.to.raise, swing_curve(u));
  pose.forward = between(figure.from.forward, figure.to.forward, swing_curve(u));
  pose.twist = between(figure.from.twist, figure.to.twist, swing_curve(u - lag));
  pose.bend = between(figure.from.bend, figure.to.bend, swing_curve(u - lag));
  pose.wrist = between(figure.from.wrist, figure.to.wrist, swing_curve(u - 2 * lag));
  return pose;
}

// `from` is the centre, `to` the half axes of the ellipse on which the arm goes round.
ArmPose circle(const ArmFigure& figure, double u) {
  const double across = std::cos(kTurn * u), up = std::sin(kTurn * u);
  ArmPose pose = figure.from;
  pose.raise += figure.to.raise * up;
  pose.forward += figure.to.forward * across;
  pose.twist += figure.to.twist * across;
  pose.bend += figure.to.bend * std::sin(kTurn * u + 0.8);
  pose.wrist += figure.to.wrist * across;
  return pose;
}

// A soft limit: as given inside, never outside, smooth between.
double limit(double x, double low, double high) {
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const double s = (x - middle) / half;
  const double knee = 0.8;
  if (std::abs(s) <= knee) return x;
  const double over = (std::abs(s) - knee) / (1 - knee);
  return middle + std::copysign(half * (knee + (1 - knee) * std::tanh(over)), s);
}

Eigen::Vector3d about(int axis, double angle) {
  return angle * Eigen::Vector3d::Unit(axis);
}

}  // namespace

ArmPose operator+(const ArmPose& a, const ArmPose& b) {
  return {a.raise + b.raise, a.forward + b.forward, a.twist + b.twist, a.bend + b.bend,
          a.wrist + b.wrist};
}

ArmPose operator*(double s, const ArmPose& a) {
  return {s * a.raise, s * a.forward, s * a.twist, s * a.bend, s * a.wrist};
}

ArmPose arm_pose(const ArmFigure& figure, int side, double beats, double attack_beats) {
  double u = beats * figure.rate;
  if (figure.hands == Hands::alternate && side == 1) u += 0.5;
  if (figure.hands == Hands::canon && side == 1) u -= 0.25;
  const double attack = std::clamp(attack_beats * figure.rate, 0.02, 0.45);
  ArmPose pose;
  if (figure.curve == Curve::wave)
    pose = wave(figure, u);
  else if (figure.curve == Curve::circle)
    pose = circle(figure, u);
  else
    pose = figure.from + progress(figure.curve, u, attack) * (figure.to + -1.0 * figure.from);
  if (figure.hands == Hands::lead && side == 1) {
    const ArmPose rest{-1.0, 0.2, -0.2, 0.6, 0};
    pose = 0.9 * rest + 0.1 * pose;
  }
  return pose;
}

double arm_travel(const ArmFigure& figure) {
  const ArmPose way = figure.to + -1.0 * figure.from;
  return std::max(
      {std::abs(way.raise), std::abs(way.forward), std::abs(way.twist), std::abs(way.bend)});
}

std::array<Eigen::Vector3d, 3> arm_rotations(const ArmPose& pose, int side) {
  const double raise = limit(pose.raise, -1.45, 1.5), forward = limit(pose.forward, -0.7, 1.7);
  const double twist = limit(pose.twist, -1.7, 1.7), bend = limit(pose.bend, 0.0, 2.45);
  const double wrist = limit(pose.wrist, -1.0, 1.0);
  const Eigen::Matrix3d shoulder = matrix_from_axis_angle(about(1, -forward)) *
                                   matrix_from_axis_angle(about(2, raise)) *
                                   matrix_from_axis_angle(about(0, twist));
  std::array<Eigen::Vector3d, 3> rotations = {axis_angle_from_matrix(shoulder), about(1, -bend),
                                              about(1, -wrist)};
  // A reflection in the plane x = 0 keeps x of a rotation vector and turns y and z.
  if (side == 1)
    for (Eigen::Vector3d& v : rotations) v = Eigen::Vector3d(v.x(), -v.y(), -v.z());
  return rotations;
}

}  // namespace mocaplm
