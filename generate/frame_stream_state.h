// One stream of a FrameDecoder: its frames so far, and what is known of the frame in the making.
#pragma once

#include <cstdint>
#include <vector>

#include "model/config.h"

namespace mocaplm {

class FrameStreamState {
 public:
  FrameStreamState() = default;
  FrameStreamState(const ModelDescription& description, std::vector<std::int32_t> prefix,
                   const std::vector<std::int32_t>& before);

  const std::vector<std::int32_t>& prefix() const { return prefix_; }
  std::int64_t frames() const { return frames_ - first_; }  // whole ones of the window
  // Forgets all but the last `count` of them.
  void keep(std::int64_t count) { first_ = frames_ - count; }

  void set_order(const std::vector<int>& channels);
  const std::vector<int>& order() const { return order_; }
  // Channels of the unfinished frame that are there, in the order's first places.
  std::size_t chosen() const { return chosen_; }
  bool frame_full() const { return chosen_ == order_.size(); }
  void choose(std::int32_t bin);
  void end_frame();

  // What model/transformer/frame_transformer.h reads of frame t of the window: (C *
  // kFrameFeatures).
  void features(std::int64_t t, float* out) const;

  // Of a channel, before frame t of the window: as ModelInput has them.
  std::int32_t velocity_row(int channel, std::int64_t t) const;
  std::int32_t last_surprise_row(int channel, std::int64_t t) const;
  // Of the channel at a place of the order, in the unfinished frame.
  std::int32_t centre(std::size_t place) const;

  int joint(std::size_t place) const { return order_[place * kJointChannels] / kJointChannels; }
  // Of a channel of the unfinished frame that was chosen.
  std::int32_t chosen_bin(int channel) const { return bin(channel, 0); }
  std::int32_t surprise_row(int channel) const;

  // What the decoder keeps of it: frames that the time model has; once the state before this frame
  // is known, each joint's and each channel's input (J and C, decoder_embd); what the state of the
  // joint in the making tells its channels (kJointChannels, decoder_embd).
  bool prefix_fed = false, ready = false;
  std::int64_t fed = 0;
  std::vector<float> joints, channels, told;

 private:
  // Bin of a channel `back` frames before the unfinished one; kNoCentre where there is none.
  std::int32_t bin(int channel, std::int64_t back) const;
  std::int32_t expected(int channel, std::int64_t back) const;
  std::int32_t row(std::int64_t distance) const;

  StreamShape shape_;
  std::int64_t reach_ = 0;
  std::vector<std::int32_t> prefix_;
  std::vector<int> order_;
  std::vector<std::int32_t> bins_;  // (frames, C), the unfinished one last
  std::int64_t frames_ = 0, first_ = 0;
  std::size_t chosen_ = 0;
};

}  // namespace mocaplm
