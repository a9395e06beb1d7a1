#include "spectral/windows.h"

#include <cassert>

#include "common/text.h"
#include "motion/resample.h"
#include "motion/skeleton.h"
#include "spectral/unwound.h"

namespace mocaplm {

std::vector<Eigen::Index> window_starts(Eigen::Index frames, Eigen::Index window,
                                        Eigen::Index stride) {
  assert(window >= 1 && stride >= 1);
  std::vector<Eigen::Index> starts;
  if (frames < window) return starts;
  for (Eigen::Index first = 0; first < frames - window; first += stride) starts.push_back(first);
  starts.push_back(frames - window);
  return starts;
}

Clip at_window_rate(const Clip& clip, const SpectralConfig& config) {
  Clip out = resample(clip, config.fps);
  const Eigen::Index had = out.frames();
  if (had >= config.window || config.short_clips != "hold") return out;
  out.poses.conservativeResize(config.window, 72);
  out.trans.conservativeResize(config.window, 3);
  for (Eigen::Index t = had; t < config.window; ++t) {
    out.poses.row(t) = out.poses.row(had - 1);
    out.trans.row(t) = out.trans.row(had - 1);
  }
  return out;
}

Series window_series(const Clip& clip, Eigen::Index first, Eigen::Index count,
                     const std::vector<int>& joints) {
  const Clip part = unwound(slice(clip, first, count));
  Series series(count, 3 * static_cast<Eigen::Index>(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i)
    series.middleCols<3>(3 * static_cast<Eigen::Index>(i)) =
        part.poses.middleCols<3>(3 * joints[i]).cast<float>();
  return series;
}

std::vector<int> config_joints(const SpectralConfig& config) {
  return parse_joints(config.joints.empty() ? std::vector<std::string>{"all"} : config.joints);
}

std::string too_short_text(const Clip& clip, const SpectralConfig& config) {
  const double frames = clip.seconds() * config.fps;
  return "is shorter than a window (" + format_fixed(clip.seconds(), 2) + " s, about " +
         format_fixed(frames, 0) + " frames at " + format_number(config.fps) +
         " per second; a window has " + std::to_string(config.window) + ", " +
         format_fixed(config.seconds(), 2) +
         " s): give a smaller --window, or --short-clips hold to hold the last frame";
}

}  // namespace mocaplm
