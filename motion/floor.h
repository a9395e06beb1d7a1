// Where the floor of a motion is: recordings have it anywhere.
#pragma once

#include "motion/clip.h"

namespace mocaplm {

// The sole of the figures that this program draws lies so far, in metres, below the foot joint of
// one who stands (viewer/figure.cpp, motion/body_mesh.h).
constexpr double kSoleBelowFoot = 0.034;

// The height, in metres, under which the lower foot (ankle and foot joints) hardly ever comes: in
// one frame of fifty.
double floor_height(const Clip& clip);

// Moves the clip so that this height is `above` metres.
void align_floor(Clip& clip, double above = 0);

}  // namespace mocaplm
