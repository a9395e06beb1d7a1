// What `mocaplm render` can be told.
#pragma once

#include <cstdint>

namespace mocaplm {

struct RenderConfig {
  std::int64_t width = 960, height = 720;
  double fps = 30;
  double at = 0;
  std::int64_t poses = 1;
  double turn = -17;
  double tilt = 10;
  bool follow = false;
  bool dark = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("width", width, 64, 4096, "of the picture, pixels");
    v.integer("height", height, 64, 4096, "of the picture, pixels");
    v.number("fps", fps, 1, 120, ".mp4, .gif (at most 50): pictures per second");
    v.number("at", at, 0, 1e6, ".png: the moment, seconds from the beginning");
    v.integer("poses", poses, 1, 24,
              ".png: so many poses from the beginning to the end in one picture, the early ones "
              "paler; 1: the one of at");
    v.number("turn", turn, -360, 360, "degrees of the camera about the vertical, 0 from the front");
    v.number("tilt", tilt, 0, 85, "degrees of the camera above the horizontal");
    v.boolean("follow", follow, "the camera goes with the dancer");
    v.boolean("dark", dark, "light figure on a dark ground");
  }
};

}  // namespace mocaplm
