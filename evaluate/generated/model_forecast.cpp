// A model's forecast at another rate than its own.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "evaluate/generated/forecast.h"
#include "motion/resample.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr double kSame = 1e-8;  // frames, less than what resample takes for the same

// The prompt ends with the seed's last frame: as many of its first frames are left out as it takes
// for that frame to lie on the model's grid, which begins at the first one. (Two of 120, at 60
// frames a second, for a model of 20.) 0 where no quarter of the seed does.
Eigen::Index left_out(Eigen::Index seed, double fps, double model_fps) {
  for (Eigen::Index first = 0; first <= seed / 4; ++first) {
    const double at = static_cast<double>(seed - 1 - first) * model_fps / fps;
    if (std::abs(at - std::round(at)) < kSame) return first;
  }
  return 0;
}

// Frames of the model's that the prompt becomes.
Eigen::Index prompt_frames(Eigen::Index seed, double fps, double model_fps) {
  return static_cast<Eigen::Index>(
             std::floor(static_cast<double>(seed - 1) * model_fps / fps + kSame)) +
         1;
}

}  // namespace

GenerateRequest model_request(const Clip& seed, Eigen::Index frames, const Generator& generator) {
  const double model_fps = generator.tokenizer().config().fps;
  const Eigen::Index first = left_out(seed.frames(), seed.fps, model_fps);
  const Eigen::Index used = seed.frames() - first;
  // The model's last frame must not lie before the forecast's.
  const double last = static_cast<double>(used - 1 + frames) * model_fps / seed.fps;
  const double whole = std::ceil(last - kSame) + 1;
  GenerateRequest request;
  request.prompt = slice(seed, first, used);
  request.seconds =
      (whole - static_cast<double>(prompt_frames(used, seed.fps, model_fps))) / model_fps;
  return request;
}

Clip model_forecast(const Clip& seed, Eigen::Index frames, const GenerateResult& result,
                    const Generator& generator) {
  const Eigen::Index used =
      seed.frames() - left_out(seed.frames(), seed.fps, generator.tokenizer().config().fps);
  const Clip whole = resample(result.clip, seed.fps);
  assert(whole.frames() >= used + frames);
  Clip forecast = slice(whole, used, frames);
  const std::vector<int>& known = generator.tokenizer().joints();
  for (int j = 0; j < kJoints; ++j)
    if (std::find(known.begin(), known.end(), j) == known.end())
      forecast.poses.middleCols<3>(3 * j) =
          seed.poses.row(seed.frames() - 1).segment<3>(3 * j).replicate(frames, 1);
  return forecast;
}

}  // namespace mocaplm
