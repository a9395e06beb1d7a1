// What arms do: a pose of one arm in angles, and figures that move it with the music.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

namespace mocaplm {

// Radians, for the left arm; the right one is its mirror image.
struct ArmPose {
  double raise = -1.2;   // upper arm over the horizontal: -1.3 hangs, 1.3 reaches up
  double forward = 0.1;  // 0 to the side, 1.5 straight ahead
  double twist = 0;      // turn about the upper arm: -1.5 lifts the bent forearm, 1.5 drops it
  double bend = 0.3;     // elbow, 0 straight
  double wrist = 0;      // bend of the hand towards the palm
};

ArmPose operator+(const ArmPose& a, const ArmPose& b);
ArmPose operator*(double s, const ArmPose& a);

enum class Curve { swing, hit, pulse, reach, circle, wave };
// Both arms mirror each other; alternate: half a cycle apart; canon: the right one follows a little
// later; lead: one arm dances, the other keeps a tenth of it.
enum class Hands { both, alternate, canon, lead };

struct ArmFigure {
  std::string name;
  Curve curve = Curve::swing;
  Hands hands = Hands::both;
  ArmPose from, to;  // the ends of the way; for a circle its centre and the half axes
  double rate = 1;   // cycles a beat
};

// The left (side 0) or right (side 1) arm `beats` after the figure began; `attack_beats`: how long
// a hit takes.
ArmPose arm_pose(const ArmFigure& figure, int side, double beats, double attack_beats);

// The longest way that one angle goes, radians.
double arm_travel(const ArmFigure& figure);

// Axis-angle of the shoulder, elbow and wrist (rows), each relative to its parent, of the left
// (side 0) or right arm. Poses are first brought into what a shoulder and an elbow can do.
std::array<Eigen::Vector3d, 3> arm_rotations(const ArmPose& pose, int side);

}  // namespace mocaplm
