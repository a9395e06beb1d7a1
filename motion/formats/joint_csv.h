// Joint positions as a table of comma-separated values (.csv), for spreadsheets and statistics.
//
//   frame,time,pelvis_x,pelvis_y,pelvis_z,left_hip_x,...,right_hand_z
//   0,0.000000,-0.001800,0.776700,0.028200,...
//
// A line a frame: the frame from 0, seconds from the clip's beginning, then SMPL's 24 joints in the
// world, metres to the micrometre, Y up.
#pragma once

#include <filesystem>
#include <string>

#include "motion/clip.h"

namespace mocaplm {

std::string joint_csv(const Clip& clip);

// Writes it; throws DataError when the clip is not sound (check_clip) or the disk refuses.
void write_joint_csv(const std::filesystem::path& path, const Clip& clip);

}  // namespace mocaplm
