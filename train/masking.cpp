#include "train/masking.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mocaplm {

namespace {

constexpr double kHalfPi = 1.57079632679489661923;

// Channels of `count` random joints (groups of three).
std::vector<bool> some_joints(const StreamShape& shape, std::size_t count, Random& random) {
  const auto channels = static_cast<std::size_t>(shape.channels);
  std::vector<std::size_t> joints((channels + 2) / 3);
  std::iota(joints.begin(), joints.end(), std::size_t{0});
  random.shuffle(joints);
  std::vector<bool> chosen(channels, false);
  for (std::size_t j = 0; j < std::min(count, joints.size()); ++j)
    for (std::size_t c = 3 * joints[j]; c < std::min(channels, 3 * joints[j] + 3); ++c)
      chosen[c] = true;
  return chosen;
}

void hide_span(std::vector<bool>& mask, const StreamShape& shape, Random& random) {
  const auto per_frame = static_cast<std::size_t>(shape.tokens_per_frame());
  const std::size_t frames = (mask.size() + per_frame - 1) / per_frame;
  const auto joints = static_cast<std::size_t>(shape.channels + 2) / 3;
  const bool all = random.below(3) == 0;
  const std::vector<bool> chosen =
      some_joints(shape, all ? joints : 1 + random.below(joints), random);
  const std::size_t length = 1 + random.below(frames), first = random.below(frames - length + 1);
  const double chance = std::cos(random.uniform() * kHalfPi);
  for (std::size_t i = first * per_frame; i < std::min(mask.size(), (first + length) * per_frame);
       ++i)
    if (i % per_frame + 1 < per_frame && chosen[i % per_frame]) mask[i] = random.uniform() < chance;
}

}  // namespace

WindowOptions window_options(const TrainConfig& config) {
  return {config.condition_dropout, config.mask_share, config.mask_spans, config.joint_subset};
}

std::vector<bool> draw_mask(const StreamShape& shape, std::size_t count,
                            const WindowOptions& options, Random& random) {
  const auto per_frame = static_cast<std::size_t>(shape.tokens_per_frame());
  std::vector<bool> mask(count, false);
  if (options.mask_spans > 0 && random.uniform() < options.mask_spans) {
    hide_span(mask, shape, random);
  } else {
    for (std::size_t i = 0; i < count; ++i)
      if (i % per_frame + 1 < per_frame) mask[i] = random.uniform() < options.mask_share;
  }
  if (count > 0 && std::find(mask.begin(), mask.end(), true) == mask.end()) {
    const std::size_t frame = random.below((count + per_frame - 1) / per_frame);
    const std::size_t channels =
        std::min(count - frame * per_frame, static_cast<std::size_t>(shape.channels));
    mask[frame * per_frame + random.below(channels)] = true;
  }
  return mask;
}

std::vector<bool> draw_hidden_channels(const StreamShape& shape, const WindowOptions& options,
                                       Random& random) {
  const auto joints = static_cast<std::size_t>(shape.channels + 2) / 3;
  if (options.joint_subset <= 0 || joints < 2 || random.uniform() >= options.joint_subset)
    return {};
  return some_joints(shape, 1 + random.below(joints - 1), random);
}

}  // namespace mocaplm
