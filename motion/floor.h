// Where the floor of a motion is: recordings have it anywhere.
#pragma once

#include <array>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

// The sole of the figures that this program draws lies so far, in metres, below the foot joint of
// one who stands.
constexpr double kSoleBelowFoot = 0.034;

// A ball in the foot of these figures that touches the ground: its middle, metres from a joint in
// the rest pose, and its radius (the same as in viewer/assets/body.js).
struct Sole {
  int joint;
  Eigen::RowVector3d middle;
  double radius;
};

// Heels, balls of the foot, toe tips; of each the left one and the right one. The soles of the rest
// pose are level within 2 mm.
const std::array<Sole, 6>& figure_soles();

// The ground below the lowest soles of each frame: the lowest of them; but where the lowest 5% of
// the frames reach more than 3 cm below the others they are taken for faults (a foot turned over, a
// start in another place) and do not lift all the others off the ground. `soles` must not be empty.
double ground_below(std::vector<double> soles);

// The same for all frames of a clip, metres.
double ground_height(const Clip& clip);

// Moves the clip so that its ground is at height 0.
void stand_on_ground(Clip& clip);

// Of the joints alone, without a body around them: the height, in metres, under which the lower
// foot (ankle and foot joints) hardly ever comes: in one frame of fifty.
double floor_height(const Clip& clip);

// Moves the clip so that this height is 0.
void align_floor(Clip& clip);

}  // namespace mocaplm
