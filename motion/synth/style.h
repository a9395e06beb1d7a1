// What is personal in a dancer's movement. The three dancers of a genre share its vocabulary and
// differ in these numbers only, and from clip to clip each of them varies a little.
#pragma once

#include <cstdint>
#include <string>

namespace mocaplm {

struct Style {
  double amplitude = 1;   // size of arm movements
  double asymmetry = 0;   // left arm larger, right arm smaller by this share
  double reach = 0;       // arms carried higher, radians
  double elbow = 0;       // elbows more bent, radians
  double sharpness = 1;   // speed of hits
  double bounce = 1;      // size of torso movements
  double posture = 0;     // chest forward, radians
  double lean = 0;        // chest to the right, radians
  double chin = 0;        // head down, radians
  double follow = 0;      // cycles by which the chest comes after the hips
  double bend = 0.03;     // lower by this, metres
  double timing = 0;      // seconds after the beat
  double width = 0.10;    // of the stance: from the middle to each foot, metres
  double turnout = 0.15;  // of the feet, radians
  double step_scale = 1;  // of step lengths
};

// Style of dancer 0, 1 or 2 of a genre.
Style dancer_style(std::uint64_t seed, const std::string& genre_code, int dancer);
// The same dancer on one day: every number a little different.
Style on_the_day(const Style& style, std::uint64_t clip_seed);

}  // namespace mocaplm
