// What `filter` and `interpolate` write: a motion as files and page, and pictures of spectra.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "viewer/page.h"

namespace mocaplm {

using NamedClips = std::vector<std::pair<std::string, Clip>>;

// The files that may be asked for; each is empty or checked to be writable before work begins.
struct SpectralFiles {
  std::string out, plot, spectrogram, json;  // a stem (generated_files), two .svg, a .json

  void check(const std::vector<std::string>& inputs) const;
  // The result as .npz and .bvh, the page, and the pictures of all clips. Returns their names.
  std::vector<std::string> write(const Clip& result, const Page& page, const NamedClips& clips,
                                 std::int64_t stft_window, std::int64_t hop) const;
};

}  // namespace mocaplm
