// How smooth a motion is, and how far two lie apart.
#pragma once

#include "motion/clip.h"

namespace mocaplm {

// Mean length of the third difference of joint positions, in m/s^3 (the jerk), over all joints but
// the pelvis, relative to it: what the root's path does is left out. 0 for fewer than 4 frames.
double roughness(const Clip& clip);

// Of the rotations' movement (their courses without the mean), the share at or above `hertz`: DCT
// coefficients k with k * fps / (2 frames) >= hertz. 0 where nothing moves.
double fast_share(const Clip& clip, double hertz = 8);

// Angle between the rotations of two clips of the same length, degrees: mean and most over frames
// and joints.
struct AngleApart {
  double mean = 0, most = 0;
};
AngleApart angle_apart(const Clip& a, const Clip& b);

}  // namespace mocaplm
