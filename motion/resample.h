// Another frame rate for a clip, and rotation vectors that do not jump in time.
#pragma once

#include <vector>

#include "motion/clip.h"

namespace mocaplm {

// The clip at `fps` frames per second: frame i lies at time i / fps, and the last frame is the last
// one that is not beyond the source's end. Rotations by slerp along the shorter arc (Shoemake
// 1985), translation linearly. Frames that fall on a source frame are that frame: all of them, bit
// for bit, when the source's rate is a whole multiple of `fps` (or equal to it). Otherwise the
// result's rotation vectors are made continuous within [-pi, pi]; where frames are only taken they
// stay as stored. Throws UsageError unless 0 < fps <= 10000, or when the result would have over 2
// million frames.
Clip resample(const Clip& clip, double fps);
// The same for whoever looks at some joints only: the others are zero, except when all frames
// are only taken.
Clip resample(const Clip& clip, double fps, const std::vector<int>& joints);

// Rewrites rotation vectors v as v + 2 pi k v / |v|, the same rotation, so that each joint follows
// its previous frame as closely as components in [-limit, limit] (radians) allow. The first frame
// is kept where it fits. Values that already follow are not touched.
void keep_continuous(Clip& clip, double limit);

}  // namespace mocaplm
