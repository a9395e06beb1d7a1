// What a hand-rounded "Frame Time:" means: 0.017 is 60 frames a second.
#pragma once

#include <string_view>

namespace mocaplm {

struct FrameRate {
  double fps = 0;
  // The digits leave room for another rate (29.97 beside 30 is one), so that the choice is to be
  // said. Never for a time that a usual rate has to its last digit: 0.04 is 25.
  bool guessed = false;
};

// The rate of a frame time of `seconds` that was written as `digits`: the usual one (24, 25, 30,
// 50, 60, 90, 100, 120, 240, ...) whose time is rounded, else cut, to these digits; else the whole
// one that they can mean; else what they say, to a thousandth.
FrameRate frame_rate(double seconds, std::string_view digits);

}  // namespace mocaplm
