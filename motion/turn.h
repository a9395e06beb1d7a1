// Turning a whole motion: about the vertical, for augmentation (thesis 5.1), or into another world.
#pragma once

#include "motion/clip.h"

namespace mocaplm {

// The motion as it would be had the dancer begun in another direction: every joint position turns
// about the y axis by `angle` radians (positive: from +Z towards +X). Only the pelvis's rotation
// vector (the shortest one) and the translation change.
Clip turned(const Clip& clip, double angle);

// Turns the world a motion lies in: every joint position x becomes turn * x. SMPL turns a body
// about its pelvis at trans + J, with J of the rest pose, which the root's rotation does not move:
// the sum is turned and J taken off again.
void turn_world(Clip& clip, const Eigen::Matrix3d& turn);

}  // namespace mocaplm
