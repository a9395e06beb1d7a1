// What positions alone tell: how large the body is, whether it is one at all, which way is up.
#pragma once

#include <string>

#include "motion/formats/up_axis.h"
#include "motion/ik/points.h"

namespace mocaplm {

// Medians over the frames, in the file's units; index 0 left, 1 right.
struct BodyMeasure {
  double thigh[2], shin[2], upper_arm[2], forearm[2];
  double hip_width = 0, shoulder_width = 0;
  double trunk = 0;          // middle of the hips to the middle of the shoulders
  double variation = 0;      // of the limb bone that changes most: its middle half over the median
  std::string variation_of;  // which: "left_hip to left_knee"

  double leg() const { return (thigh[0] + thigh[1] + shin[0] + shin[1]) / 2; }
};

BodyMeasure measure_body(const PointTracks& tracks);
// The same of the SMPL figure.
const BodyMeasure& smpl_measure();

// Throws DataError when these cannot be the joints of a person, whatever the unit: bones of no
// length, left and right unlike, arms against legs, lengths that change from frame to frame. That
// is what joints in another order look like.
void check_body(const BodyMeasure& body, const std::string& file);

// Throws DataError when the body is a mirrored one: toes, or bent knees, that point backwards all
// the time, from axes of the left hand or sides exchanged.
void check_handedness(const PointTracks& tracks, const std::string& file);

struct FoundUp {
  UpAxis axis = UpAxis::y;
  double share = 0;   // of the body's direction along it, -1 to 1, averaged over the frames
  double second = 0;  // the same of the next best axis
  bool sure() const { return share > 0.55 && share > 1.5 * second; }
};
// From the way from the feet over the hips to the shoulders.
FoundUp find_up(const PointTracks& tracks);

}  // namespace mocaplm
