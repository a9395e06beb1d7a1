// From a performance to a clip: the pelvis over its feet, the legs by inverse kinematics, spine and
// arms.
#pragma once

#include "motion/synth/perform.h"

namespace mocaplm {

// Poses and translation; planted toes stay where they are to numerical precision.
Clip embody(const Performance& performance);

}  // namespace mocaplm
