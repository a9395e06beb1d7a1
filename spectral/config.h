// What a window of motion is and which spectral features stand for it (thesis 3.4).
#pragma once

#include <string>
#include <vector>

#include "common/settings.h"

namespace mocaplm {

struct SpectralConfig {
  std::string feature = "stft";
  double fps = 60;
  std::int64_t window = 128;
  std::int64_t stride = 32;
  std::vector<std::string> joints;
  std::int64_t stft_window = 16;
  std::int64_t stft_hop = 0;
  std::int64_t coefficients = 16;
  std::int64_t reduce = 0;
  std::string short_clips = "skip";

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("feature", feature, {"stft", "dct", "pca", "pose"},
             "what is compared: magnitudes of the short-time Fourier transform, the lowest DCT "
             "coefficients, principal components over time, or the rotations themselves");
    v.number("fps", fps, 1, 1000, "frames per second at which windows are cut");
    v.integer("window", window, 2, 4096, "frames of a window; 128 at 60 fps are 2.13 s");
    v.integer("stride", stride, 1, 100000, "frames from one window of a clip to the next");
    v.texts("joints", joints,
            "joints or groups whose rotations count (default: all 24, 72 components)");
    v.integer("stft_window", stft_window, 2, 4096, "frames of the Fourier transform's Hann window");
    v.integer("stft_hop", stft_hop, 0, 4096,
              "frames from one Hann window to the next; 0 for half of it");
    v.integer("coefficients", coefficients, 1, 4096,
              "dct, pca: values kept of each rotation component's course");
    v.integer("reduce", reduce, 0, 4096,
              "principal components kept of all features of a window together; 0 keeps the "
              "features as they are");
    v.choice("short_clips", short_clips, {"skip", "hold"},
             "clips shorter than a window: left out, or their last frame is held");
  }

  std::int64_t hop() const { return stft_hop > 0 ? stft_hop : (stft_window + 1) / 2; }
  double seconds() const { return static_cast<double>(window) / fps; }
};

// Throws UsageError where settings contradict each other (a Hann window longer than the window,
// more coefficients than frames, unknown joints).
void check_config(const SpectralConfig& config);

}  // namespace mocaplm
