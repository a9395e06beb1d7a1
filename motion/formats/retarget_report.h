// How the figure of a file was matched to SMPL's.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "motion/formats/remark.h"

namespace mocaplm {

// The angle between a bone of the source and the same bone of the SMPL figure after conversion,
// degrees.
struct LimbError {
  std::string limb;  // "left_upper_arm", ...
  double mean = 0, max = 0;
  Eigen::Index worst_frame = 0;
  Eigen::Index frames = 0;  // in which the bone has a length
};

struct RetargetReport {
  std::string scheme;            // which naming scheme or map file
  double unit = 0;               // metres per unit of the file
  double height = 0;             // metres from the soles to the top of the head, about
  double path_scale = 1;         // the root's path was multiplied by it, so that feet stay planted
  std::string rest_pose;         // from which pose rotations were counted: "the zero pose", ...
  std::vector<LimbError> limbs;  // upper and lower arms and legs that both figures have
  double mean_degrees = 0;       // over those limbs and all frames
  double max_degrees = 0;
  std::vector<Remark> remarks;         // of the file's text and of the figure
  std::vector<std::string> unmatched;  // SMPL joints without a source: they follow or interpolate
};

}  // namespace mocaplm
