#include "render/render.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/error.h"
#include "common/files.h"
#include "common/parallel.h"
#include "common/progress.h"
#include "common/text.h"
#include "motion/floor.h"
#include "motion/resample.h"
#include "render/ffmpeg.h"
#include "render/stage.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr Eigen::Index kPaletteFrames = 12;  // that a .gif takes its 256 colours from
// A .gif counts hundredths of a second, and what is to be seen for one of them browsers show for
// ten.
constexpr double kGifMaxFps = 50;
// What the frames that are drawn at a time may take together, and a pixel of one of them: a layer's
// four points, and the pictures that wait for their turn.
constexpr std::size_t kDrawingBytes = std::size_t{2} << 30, kPixelBytes = 48;

std::string ending(const fs::path& path) {
  return lower(path.extension().string());
}

Picture still(const Clip& clip, const RenderConfig& config) {
  std::vector<Eigen::Index> frames;
  if (config.poses == 1) {
    frames = {static_cast<Eigen::Index>(std::llround(config.at * clip.fps))};
    if (frames[0] >= clip.frames())
      throw UsageError("--at " + format_number(config.at) + ": the clip has only " +
                       format_fixed(clip.seconds(), 2) + " s");
    // The camera is for this frame, not for the whole way.
    return Stage(slice(clip, frames[0], 1), config).frame(0);
  }
  for (std::int64_t i = 0; i < config.poses; ++i)
    frames.push_back(static_cast<Eigen::Index>(
        std::llround(static_cast<double>(i) * static_cast<double>(clip.frames() - 1) /
                     static_cast<double>(config.poses - 1))));
  // A clip may have fewer frames: none is drawn twice, which would darken its shadow.
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return Stage(clip, config).poses(frames);
}

// As many as are asked for, fewer where so many large pictures would take too much memory.
std::int64_t drawing_threads(const RenderConfig& config, std::int64_t threads) {
  const std::size_t frame = kPixelBytes * static_cast<std::size_t>(config.width) *
                            static_cast<std::size_t>(config.height);
  return static_cast<std::int64_t>(
      std::clamp<std::size_t>(kDrawingBytes / frame, 1, worker_count(threads)));
}

// Draws every `step`-th frame, several at a time, and hands them on in order.
void draw_frames(const Stage& stage, Eigen::Index step, std::int64_t threads,
                 const std::function<void(const Picture&)>& take) {
  const Eigen::Index count = (stage.frames() + step - 1) / step;
  const auto at_once = static_cast<Eigen::Index>(4 * worker_count(threads));
  std::vector<Picture> pictures(static_cast<std::size_t>(std::min(count, at_once)));
  for (Eigen::Index first = 0; first < count; first += at_once) {
    const auto some = static_cast<std::size_t>(std::min(at_once, count - first));
    parallel_for(some, threads, [&](std::size_t i) {
      pictures[i] = stage.frame(step * (first + static_cast<Eigen::Index>(i)));
    });
    for (std::size_t i = 0; i < some; ++i) take(pictures[i]);
  }
}

class Film {
 public:
  Film(const Clip& clip, const RenderConfig& config, std::int64_t threads)
      : program_(find_ffmpeg()),
        config_(config),
        threads_(drawing_threads(config, threads)),
        stage_(resample(clip, config.fps), config) {}

  Eigen::Index frames() const { return stage_.frames(); }

  // H.264, which every browser and player shows; an odd row or column is filled up.
  void write_mp4(const fs::path& file) const {
    run(1, "drawing",
        {"-an", "-vf", "scale=out_color_matrix=bt709,pad=ceil(iw/2)*2:ceil(ih/2)*2,format=yuv420p",
         "-c:v", "libx264", "-crf", "20", "-colorspace", "bt709", "-color_primaries", "bt709",
         "-color_trc", "bt709", "-movflags", "+faststart", "-f", "mp4", "file:" + file.string()});
  }

  // First the colours, of a few frames; ffmpeg alone would keep all frames in memory for that.
  void write_gif(const fs::path& file) const {
    const fs::path palette = file.string() + ".palette.png";
    try {
      run(std::max<Eigen::Index>(frames() / kPaletteFrames, 1), "choosing colours",
          {"-vf", "palettegen", "-f", "image2", "-update", "1", "file:" + palette.string()});
      run(1, "drawing",
          {"-i", "file:" + palette.string(), "-lavfi", "paletteuse=dither=bayer:bayer_scale=4",
           "-f", "gif", "file:" + file.string()});
    } catch (...) {
      fs::remove(palette);
      throw;
    }
    fs::remove(palette);
  }

 private:
  void run(Eigen::Index step, const std::string& what,
           const std::vector<std::string>& output) const {
    Ffmpeg ffmpeg(program_, static_cast<int>(config_.width), static_cast<int>(config_.height),
                  config_.fps, output);
    Progress progress(what, static_cast<std::size_t>((frames() + step - 1) / step), "frames");
    draw_frames(stage_, step, threads_, [&](const Picture& picture) {
      ffmpeg.write(picture);
      progress.add();
    });
    ffmpeg.finish();
    progress.finish();
  }

  std::string program_;
  RenderConfig config_;
  std::int64_t threads_;
  Stage stage_;
};

}  // namespace

void check_render(const fs::path& path, const RenderConfig& config) {
  const std::string format = ending(path);
  if (format != ".png" && format != ".mp4" && format != ".gif")
    throw UsageError("cannot draw to \"" + path.string() +
                     "\": the name must end in .png, .mp4 or .gif");
  if (format == ".png" && config.poses > 1 && config.follow)
    throw UsageError("--poses shows the whole way from one place: leave --follow out");
  if (format == ".gif" && config.fps > kGifMaxFps)
    throw UsageError("--fps " + format_number(config.fps) + ": a .gif shows at most " +
                     format_number(kGifMaxFps) + " pictures a second; .mp4 shows more");
  if (format != ".png") find_ffmpeg();
}

std::int64_t render_clip(const Clip& clip, const fs::path& path, const RenderConfig& config,
                         std::int64_t threads) {
  check_render(path, config);
  Clip standing = clip;
  stand_on_ground(standing);
  if (ending(path) == ".png") {
    write_file(path, png_bytes(still(standing, config)));
    return 1;
  }
  const Film film(standing, config, threads);
  write_file_with(path, [&](const fs::path& file) {
    ending(path) == ".mp4" ? film.write_mp4(file) : film.write_gif(file);
  });
  return film.frames();
}

}  // namespace mocaplm
