// What shows whether a dance is alive and bounded: how the root travels, how much and how roughly
// the body moves, and whether feet slide.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

struct Average {
  double sum = 0, count = 0;

  void add(double value) { sum += value, ++count; }
  void add(const Average& other) { sum += other.sum, count += other.count; }
  // Not a number without values.
  double value() const {
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  }
};

// Metres and seconds; "root" is the pelvis, its distances are horizontal. Averages are over frames
// (and joints or feet) of all clips that were added.
struct MotionMeasures {
  Average root_speed;
  Average root_2s;        // from where it was 2 s before
  Average root_end;       // from its first to its last frame; one value a clip
  Average root_farthest;  // the most it gets from its first frame; one value a clip
  Average height;         // of the pelvis
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;  // the pelvis
  Average joint_speed;         // relative to the pelvis
  Average acceleration, jerk;  // of joints in the world: their second and third differences
  Average contact;             // share of feet on the floor
  Average contact_speed;       // horizontal, of feet on the floor
  Average skating;             // share of frames in which a foot on the floor exceeds kSkating
  Average frozen;              // share of frames in which nothing moves; filled by the caller

  void add(const MotionMeasures& other);
};

// A foot is on the floor while its toe (SMPL's left_foot, right_foot) is less than 5 cm above it
// in a frame and the one before; it skates when it moves faster than 0.5 m/s there (Karunratanakul
// et al., "Guided motion diffusion for controllable human motion synthesis", ICCV 2023).
constexpr double kContactHeight = 0.05, kSkating = 0.5;

// The floor as the toes have it: the median over the frames of the lower one. Recordings that were
// made for another body float over or sink into the ground by centimetres, each by its own.
double toe_level(const Clip& clip);

// `joints` are those whose speed and roughness count.
MotionMeasures measure_motion(const Clip& clip, const std::vector<int>& joints, double floor);

}  // namespace mocaplm
