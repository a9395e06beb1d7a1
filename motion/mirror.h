// Left-right mirroring of motion, for augmentation (thesis, appendix A.5).
#pragma once

#include "motion/clip.h"

namespace mocaplm {

// The motion seen in a mirror on the plane x = 0: left and right joints swap, the y and z
// components of every rotation vector and the pelvis's x change sign. Joint positions are mirrored
// up to the rest pose's own asymmetry (about 1 cm); the pelvis joint exactly. The words "left" and
// "right" in label values swap too ("raise-up-left-hand"). Mirroring twice gives the clip back.
Clip mirror(const Clip& clip);

}  // namespace mocaplm
