#include "generate/frame_stream_state.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "common/angles.h"
#include "model/input.h"

namespace mocaplm {

FrameStreamState::FrameStreamState(const ModelDescription& description,
                                   std::vector<std::int32_t> prefix,
                                   const std::vector<std::int32_t>& before)
    : shape_(description.shape),
      reach_(description.config.reach),
      prefix_(std::move(prefix)),
      order_(static_cast<std::size_t>(shape_.channels)) {
  std::iota(order_.begin(), order_.end(), 0);
  const auto per_frame = static_cast<std::size_t>(shape_.tokens_per_frame());
  assert(before.size() % per_frame == 0);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (i % per_frame + 1 < per_frame)
      bins_.push_back(before[i] - static_cast<std::int32_t>(shape_.first_bin));
  frames_ = first_ = static_cast<std::int64_t>(before.size() / per_frame);
  bins_.resize(bins_.size() + order_.size(), kNoCentre);
}

void FrameStreamState::set_order(const std::vector<int>& channels) {
  assert(chosen_ == 0 && channels.size() == order_.size());
  for (std::size_t i = 0; i < channels.size(); ++i)  // joint after joint
    assert(channels[i] % kJointChannels == static_cast<int>(i % kJointChannels) &&
           (i % kJointChannels == 0 || channels[i] == channels[i - 1] + 1));
  order_ = channels;
}

void FrameStreamState::choose(std::int32_t bin) {
  assert(!frame_full());
  bins_[static_cast<std::size_t>(frames_ * shape_.channels + order_[chosen_++])] = bin;
}

void FrameStreamState::end_frame() {
  assert(frame_full());
  chosen_ = 0;
  ready = false;
  ++frames_;
  bins_.resize(bins_.size() + order_.size(), kNoCentre);
}

void FrameStreamState::features(std::int64_t t, float* out) const {
  const auto value = [&](std::int64_t frame, std::int64_t c) {
    return static_cast<float>(
        bins_[static_cast<std::size_t>((first_ + frame) * shape_.channels + c)]);
  };
  for (std::int64_t c = 0; c < shape_.channels; ++c, out += kFrameFeatures) {
    const float u = (2 * value(t, c) + 1) / static_cast<float>(shape_.bins) - 1;
    out[0] = u;
    for (int i = 0; i < 3; ++i) {
      const auto angle = static_cast<float>((1 << i) * kPi) * u;
      out[1 + 2 * i] = std::sin(angle);
      out[2 + 2 * i] = std::cos(angle);
    }
    const auto turn = [&](std::int64_t frame) {
      return frame < 2 ? 0 : value(frame, c) - 2 * value(frame - 1, c) + value(frame - 2, c);
    };
    out[7] = t < 1 ? 0 : std::asinh(value(t, c) - value(t - 1, c)) * 0.5f;
    out[8] = std::asinh(turn(t)) * 0.5f;
    out[9] = std::asinh(turn(t - 1)) * 0.5f;
    constexpr auto kMost = static_cast<float>(kMostChange);
    for (std::int64_t lag = 0; lag < kFrameLags; ++lag)
      out[10 + lag] = std::clamp(turn(t - lag), -kMost, kMost) * 0.25f;
  }
}

std::int32_t FrameStreamState::bin(int channel, std::int64_t back) const {
  return back > frames_
             ? kNoCentre
             : bins_[static_cast<std::size_t>((frames_ - back) * shape_.channels + channel)];
}

std::int32_t FrameStreamState::expected(int channel, std::int64_t back) const {
  const std::int32_t one = bin(channel, back + 1), two = bin(channel, back + 2);
  if (one == kNoCentre) return kNoCentre;
  return two == kNoCentre ? one : 2 * one - two;
}

std::int32_t FrameStreamState::row(std::int64_t distance) const {
  return static_cast<std::int32_t>(std::clamp(distance, -reach_, reach_) + reach_ + 1);
}

std::int32_t FrameStreamState::centre(std::size_t place) const {
  return expected(order_[place], 0);
}

std::int32_t FrameStreamState::velocity_row(int channel, std::int64_t t) const {
  const std::int64_t back = frames() - t;
  const std::int32_t one = bin(channel, back + 1), two = bin(channel, back + 2);
  return one == kNoCentre || two == kNoCentre ? 0 : row(one - two);
}

std::int32_t FrameStreamState::last_surprise_row(int channel, std::int64_t t) const {
  const std::int64_t back = frames() - t;
  const std::int32_t now = bin(channel, back + 1), before = expected(channel, back + 1);
  return now == kNoCentre || before == kNoCentre ? 0 : row(now - before);
}

std::int32_t FrameStreamState::surprise_row(int channel) const {
  const std::int32_t now = bin(channel, 0), before = expected(channel, 0);
  return before == kNoCentre ? 0 : row(now - before);
}

}  // namespace mocaplm
