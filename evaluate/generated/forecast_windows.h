// What is forecast: windows of a clip, a part that is shown and a part that is to come; and the
// forecasts that need no model.
#pragma once

#include <vector>

#include "motion/clip.h"

namespace mocaplm {

struct ForecastWindow {
  Clip seed, target;  // at one rate; the target begins a frame after the seed's end
};

// Windows of seed + 1 s (the protocol's 3 s; more where `ahead` asks for it), each beginning one
// seed's length after the one before. `seed` and `ahead` count frames. A shorter clip has none.
std::vector<ForecastWindow> forecast_windows(const Clip& clip, Eigen::Index seed,
                                             Eigen::Index ahead);

// The last frame, again and again.
Clip zero_velocity(const Clip& seed, Eigen::Index frames);

// Every joint goes on turning, relative to its parent, about the axis and at the speed of the last
// step, and the root goes on in its direction: rotations, whatever the length. A seed of one frame
// stays as it is.
Clip linear_extrapolation(const Clip& seed, Eigen::Index frames);

}  // namespace mocaplm
