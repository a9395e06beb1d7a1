// Clips cut into windows of a fixed number of frames, all at one frame rate.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "spectral/config.h"

namespace mocaplm {

// (frames, channels): rotation vector components, radians.
using Series = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// First frames of the windows of a clip of `frames` frames: every `stride`-th, and the last that
// fits. None when the clip is shorter than `window`.
std::vector<Eigen::Index> window_starts(Eigen::Index frames, Eigen::Index window,
                                        Eigen::Index stride);

// The clip at the config's rate; a clip shorter than a window is held in its last frame up to a
// window's length when config.short_clips says so. Throws UsageError as resample does.
Clip at_window_rate(const Clip& clip, const SpectralConfig& config);

// The rotations of `joints` in frames [first, first + count). They begin with each joint's shortest
// rotation vector and never jump by a turn after that, so that the same motion gives the same
// values wherever in a clip it lies.
Series window_series(const Clip& clip, Eigen::Index first, Eigen::Index count,
                     const std::vector<int>& joints);

// config.joints as indices; all of them when it names none.
std::vector<int> config_joints(const SpectralConfig& config);

// "shorter than a window (54 frames at 60 fps, a window has 128)" and what to do about it.
std::string too_short_text(const Clip& clip, const SpectralConfig& config);

}  // namespace mocaplm
