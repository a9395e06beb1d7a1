// Turning a whole motion about the vertical, for augmentation (thesis 5.1).
#pragma once

#include "motion/clip.h"

namespace mocaplm {

// The motion as it would be had the dancer begun in another direction: every joint position turns
// about the y axis by `angle` radians (positive: from +Z towards +X). Only the pelvis's rotation
// vector (the shortest one) and the translation change.
Clip turned(const Clip& clip, double angle);

}  // namespace mocaplm
