// Names of joints and key points in files of positions: SMPL's, OpenPose's and HALPE's ("RHip",
// "LBigToe", "MidHip"), COCO's ("left_hip"), MediaPipe's ("left_foot_index"), Kinect's
// ("KneeRight"), joint centres ("RHJC") and bones called by their beginning ("LeftUpLeg").
#pragma once

#include <array>
#include <string>
#include <vector>

#include "motion/ik/points.h"

namespace mocaplm {

struct PointNames {
  std::array<int, kPoints> index;     // of the name that is the point, -1 for none
  std::vector<std::string> left_out;  // names that are used for nothing, in their order
  std::vector<std::string> missing;   // of needed_points(), as point_name says them
};

// In any case and order of words, with sides as left_, Right, L, _r or .L, and a subject before a
// colon. A "foot" is the ankle where no ankle is named, else the toes; a "hand" in the same way
// the wrist; a "shoulder" beside an upper arm is the collar. The first of several names wins.
PointNames find_points(const std::vector<std::string>& names);

// Whether these are markers on the skin, of the Plug-in Gait set and its relatives ("LASI", "C7",
// "RKNE", "R.ASIS"): where joints lie has to be solved from them first.
bool are_skin_markers(const std::vector<std::string>& names);

}  // namespace mocaplm
