// A clip as a picture (.png) or a film (.mp4, .gif).
#pragma once

#include <cstdint>
#include <filesystem>

#include "motion/clip.h"
#include "render/config.h"

namespace mocaplm {

// Throws UsageError for another ending, when it needs ffmpeg and there is none, and for settings
// that it cannot have (over 50 pictures a second in a .gif, several poses and a camera that
// follows).
void check_render(const std::filesystem::path& path, const RenderConfig& config);

// Draws and writes it, put with its soles on the floor; returns the number of pictures. A film
// shows the clip resampled to config.fps. Throws as check_render does, UsageError when
// config.at lies beyond the clip's end, DataError when ffmpeg fails or the disk refuses.
std::int64_t render_clip(const Clip& clip, const std::filesystem::path& path,
                         const RenderConfig& config, std::int64_t threads);

}  // namespace mocaplm
