// Settings of motion interpolation (thesis 3.5).
#pragma once

#include <cstdint>
#include <string>

#include "common/settings.h"

namespace mocaplm {

struct InterpolateConfig {
  std::string target = "dct";
  double fps = 60;
  std::int64_t steps = 200;
  double rate = 0.1;
  double weight = 0.5;
  double from_hz = 0;
  double to_hz = 4;
  std::int64_t stft_window = 16;
  std::int64_t stft_hop = 0;
  std::int64_t coefficients = 16;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("target", target, {"dct", "stft", "pca", "own_pca"},
             "spectral features that shall come near the second motion's; pca: components over "
             "time of both motions together, own_pca: each motion's own");
    v.number("fps", fps, 1, 1000, "frames per second of both motions and of the result");
    v.integer("steps", steps, 0, 1000000, "steps of gradient descent");
    v.number("rate", rate, 1e-6, 1,
             "length of a step; 1 would meet the DCT's target at once. A step that does not lower "
             "the loss is taken back and halved");
    v.number("weight", weight, 0, 1,
             "pull of the second motion's features, the rest is the first one's: 1 for the target "
             "alone");
    v.number("from_hz", from_hz, 0, 500, "dct, stft: lowest frequency that takes part");
    v.number("to_hz", to_hz, 0, 500, "dct, stft: highest frequency that takes part");
    v.integer("stft_window", stft_window, 2, 4096, "frames of the Fourier transform's Hann window");
    v.integer("stft_hop", stft_hop, 0, 4096,
              "frames from one Hann window to the next; 0 for half of it");
    v.integer("coefficients", coefficients, 1, 4096, "pca, own_pca: components over time");
  }

  std::int64_t hop() const { return stft_hop > 0 ? stft_hop : (stft_window + 1) / 2; }
};

// Which clips of a dataset are interpolated to compare the targets.
struct InterpolatePairs {
  std::int64_t pairs = 12;
  std::int64_t seed = 1;
  double seconds = 8;
  std::string split = "all";

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("pairs", pairs, 1, 100000, "pairs of clips, no clip in two of them");
    v.integer("seed", seed, 0, 1000000000, "what the pairs are drawn with");
    v.number("seconds", seconds, 2, 60,
             "most of a clip that takes part, from its beginning; clips under 2 s are left out");
    v.choice("split", split, {"all", "train", "validation", "test"}, "whose clips are drawn");
  }
};

}  // namespace mocaplm
