// Inverse kinematics of one leg in closed form: two bones, a knee that is a hinge.
#pragma once

#include <Eigen/Core>

namespace mocaplm {

struct LegRotations {
  Eigen::Vector3d hip, knee, ankle;  // axis-angle, each relative to its parent
  double short_of = 0;               // metres by which the ankle misses its target
};

// The longest distance from hip to ankle that the solver gives: a nearly straight knee. Metres.
double longest_leg(int side);

// Turns the leg of `side` (0 left, 1 right) so that its ankle is at `ankle` and its foot has the
// world rotation `foot`. `hip` is the hip joint's place (world, metres), `pelvis` the pelvis' world
// rotation, `across` the direction of the knee's axis, to the body's left (world). Out of reach,
// the leg points at the target with a straight knee.
LegRotations solve_leg(int side, const Eigen::Vector3d& hip, const Eigen::Vector3d& ankle,
                       const Eigen::Matrix3d& pelvis, const Eigen::Matrix3d& foot,
                       const Eigen::Vector3d& across);

}  // namespace mocaplm
