// At how many frames a second a take is read so that nothing of it is lost.
#pragma once

#include <string>
#include <vector>

#include "motion/formats/scene.h"

namespace mocaplm {

struct SceneRate {
  double fps = 0;
  std::vector<Remark> remarks;  // where it was guessed or capped
};

// A rate with a frame at every key, the first at `begin`: that of the keys where they come in equal
// steps, else the smallest usual one (24, 25, 30, ... 240, and the television's 23.976, 29.97 and
// 59.94) that meets all of them within 0.1 ms, or 0.6 ms where times were written with three
// digits; whole multiples of rates under 24. At most 240, with a remark. `times`: seconds, in any
// order, those of all keys of a take that moves. `curves`: the format may join them by curves, so
// few of them get a remark.
SceneRate scene_rate(std::vector<double> times, double begin, bool curves, const std::string& take);

}  // namespace mocaplm
