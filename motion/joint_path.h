// The path of one joint through a clip.
#pragma once

#include "motion/clip.h"

namespace mocaplm {

// (T, 3) metres. `in_body`: from the pelvis, in the frame of one who stands upright and faces +Z in
// the first frame, so that neither the place nor the heading of a recording matters; else in the
// world.
Eigen::MatrixXd joint_path(const Clip& clip, int joint, bool in_body);

}  // namespace mocaplm
