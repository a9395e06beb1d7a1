// What feet do: step patterns, and the paths on which they carry both feet from place to place. A
// foot is either planted, and then does not move at all, or swings to its next place.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

// Height of the toe joint over the floor when the foot is flat, metres.
constexpr double kToeHeight = 0.02;

// One step of a pattern; lengths in metres, in the dancer's heading after the step's turn.
struct Step {
  double beat = 0;            // when the foot lands, in beats from the pattern's beginning
  int foot = 0;               // 0 left, 1 right
  double out = 0, front = 0;  // the foot's place, out to its own side and to the front
  double move_left = 0, move_front = 0;  // how far the dancer's spot moves with this step
  double turn = 0;                       // of the heading, radians, positive to the left
  double lift = 0.09;                    // of the toe over the floor
  double kick = 0;                       // how far the foot shoots to the front on its way
};

struct FootFigure {
  std::string name;
  double beats = 4;  // the pattern repeats after this many
  double bend = 0;   // the pelvis is this much lower, metres
  std::vector<Step> steps;
};

// The same steps of the other foot to the other side.
FootFigure mirrored(FootFigure figure);

// A step with everything resolved, ready to be placed in time (seconds from the clip's start).
struct PlannedStep {
  Step step;
  double time = 0;
};

// The way of one foot, a row a frame.
struct FootPath {
  Translations toe;       // world position of the toe joint, metres
  Eigen::VectorXd yaw;    // heading of the foot, radians
  Eigen::VectorXd pitch;  // toe down, radians
};

struct FootPlan {
  std::array<FootPath, 2> feet;
  Eigen::VectorXd heading;  // of the dancer, radians, not yet smoothed
  Eigen::VectorXd weight;   // share of the weight that the left foot carries, 0 to 1
};

struct Stance {
  double width = 0.10;    // from the middle to each foot, metres
  double turnout = 0.15;  // of each foot, radians
  double step_scale = 1;  // of all step lengths
  double swing = 0.36;    // longest time in the air, seconds
  double heading = 0;     // at the start
};

// Steps in order of time. Steps that would leave a foot no time to swing are left out.
FootPlan plan_feet(const std::vector<PlannedStep>& steps, const Stance& stance, double fps,
                   Eigen::Index frames);

// From the toe joint back to the ankle, in the foot's own frame, metres.
Eigen::Vector3d toe_to_ankle(int side);
// World rotation of a foot with this yaw, toe down by `pitch`.
Eigen::Matrix3d foot_rotation(double yaw, double pitch);

}  // namespace mocaplm
