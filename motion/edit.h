// What is done to a motion on its way from one file to another.
#pragma once

#include "motion/clip.h"

namespace mocaplm {

struct EditConfig {
  double fps = 0;
  bool mirror = false;
  bool face = false;
  bool floor = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("fps", fps, 0, 10000, "frames per second of the result; 0: as the clip has them");
    v.boolean("mirror", mirror, "swap left and right");
    v.boolean("face", face, "turn the motion so that its first frame faces +Z");
    v.boolean("floor", floor, "move the motion up or down so that the soles stand at height 0");
  }
};

// The clip resampled (motion/resample.h), mirrored (motion/mirror.h), turned about the vertical
// through the pelvis of its first frame, and put with its soles on the floor (motion/floor.h), in
// this order, as far as it is asked for. Throws UsageError as resample does.
Clip edited(const Clip& clip, const EditConfig& config);

// The direction in which the pelvis faces in one frame: radians about +Y, 0 towards +Z, positive
// towards +X. 0 where the pelvis faces straight up or down, lying.
double facing(const Clip& clip, Eigen::Index frame);

}  // namespace mocaplm
