// What one can see of a motion with the naked eye, as numbers: how the trunk stands, where hips,
// shoulders, head and feet point, where the soles are and whether planted feet stay in place. A
// figure that was put together wrongly shows here, however exact its limbs are.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/remark.h"
#include "motion/formats/retarget_report.h"

namespace mocaplm {

struct BodyPosture {
  // In the first frame, metres, our world (Y up).
  Eigen::Vector3d trunk;                // from the middle of the hips to that of the shoulders
  Eigen::Vector3d hip_line;             // from the right hip to the left one
  Eigen::Vector3d shoulder_line;        // likewise
  Eigen::Vector3d head;                 // from the pelvis joint to the head joint
  std::array<Eigen::Vector3d, 2> feet;  // from the ankle to the foot joint, left and right

  // Means over the frames looked at, degrees.
  double lean = 0;       // of the trunk against the vertical, 0 to 180
  double twist = 0;      // of the hip line against the shoulder line, seen along the trunk
  double head_turn = 0;  // of the face against the chest's facing
  std::array<double, 2> feet_turn{};  // of level feet against the hips' facing

  double height = 0;       // metres from the lowest sole to the top of the head, at its highest
  double lowest_foot = 0;  // height of the lowest foot joint of all, metres over 0
  double usual_foot = 0;   // of the lower foot joint, under which it comes in 5% of the frames
  double travel = 0;       // mean speed of the pelvis over the floor, cm/s
  // Speed of a planted foot, cm/s: of the points of the sole that touch the ground, as far as the
  // clip shows it (within 3 cm of its lowest soles over a thirtieth of a second), that of the
  // slower foot; the lower quartile of the frames, for feet roll, and dancers slide now and then.
  // None where no foot is planted in at least eight of the frames looked at.
  std::optional<double> slide;

  // Shares of the frames looked at.
  double lying = 0;             // lean over 60 degrees
  double upside_down = 0;       // lean over 120 degrees
  double hips_across = 0;       // twist over 60 degrees
  double shoulders_folded = 0;  // the shoulders less than 0.7 times as far apart as at rest
  double head_backwards = 0;    // head_turn over 110 degrees
  double head_down = 0;  // crown of the head more than 120 degrees from the trunk's direction
  std::array<double, 2> feet_backwards{};   // a level foot more than 110 degrees from the facing
  std::array<double, 2> ankles_turned{};    // turned by more than 100 degrees against the shin
  std::array<double, 2> knees_backwards{};  // bent by more than 20 degrees the wrong way
};

// Looks at `most` frames at most, evenly spread; 0: all. The clip must not be empty.
BodyPosture measure_posture(const Clip& clip, Eigen::Index most = 0);

// What is unlikely of a person: each a remark whose kind is the same for the same trouble. Of a
// skeleton that was matched (`report.scheme` not empty) its size and unit too. Thresholds are such
// that recordings known as sound give none: a dancer may lie down, slide, or stand on a stage.
std::vector<Remark> unlikely(const BodyPosture& posture, const RetargetReport& report);

}  // namespace mocaplm
