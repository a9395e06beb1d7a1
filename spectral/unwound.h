// Rotation vectors as courses that may be transformed: without the jumps by a turn that files have.
#pragma once

#include "motion/clip.h"

namespace mocaplm {

// The clip with each joint's rotation vectors running on without jumps, as many turns as it takes,
// from the shortest one in the first frame.
Clip unwound(const Clip& clip);
// The same, from those nearest to the first ones of `beside`, so that the way between both motions
// is short.
Clip unwound_beside(const Clip& clip, const Clip& beside);
// The same rotations with components within [-pi, pi] where possible, as files hold them.
Clip wound(const Clip& clip);

}  // namespace mocaplm
