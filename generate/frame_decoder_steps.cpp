// The steps of a frame decoder: frames through the time model, each channel's past, the channels of
// the frame in the making.
#include <algorithm>

#include "generate/frame_decoder.h"
#include "generate/tables.h"
#include "model/input.h"

namespace mocaplm {

void FrameDecoder::catch_up(const Sequences& sequences) {
  Sequences late;
  for (const std::int64_t s : sequences) {
    if (at(s).ready) continue;
    if (!at(s).prefix_fed) feed_prefix(s);
    late.push_back(s);
  }
  while (feed_frames(late)) {
  }
}

void FrameDecoder::feed_prefix(std::int64_t sequence) {
  FrameStreamState& stream = at(sequence);
  const std::int64_t width = time_.width();
  for (std::size_t i = 0; i < stream.prefix().size(); ++i) {
    const std::int64_t position = time_.length(sequence);
    float* x = time_.add(sequence);
    std::fill(x, x + width, 0.f);
    add_row(x, time_tables_.token, stream.prefix()[i], width);
    add_row(x, time_tables_.position, position, width);
    if (time_.full() || i + 1 == stream.prefix().size()) time_.run();
  }
  stream.prefix_fed = true;
  remember({{sequence, 0, time_.rows() - 1}});
}

// As many frames of these sequences as are computed together; false when none is left.
bool FrameDecoder::feed_frames(const Sequences& sequences) {
  std::vector<Reached> reached;
  const std::int64_t width = time_.width(), features = frame_in_.in();
  for (const std::int64_t s : sequences)
    for (FrameStreamState& stream = at(s);
         stream.fed < stream.frames() && static_cast<std::int64_t>(reached.size()) < kMaxRows;) {
      const auto row = static_cast<std::int64_t>(reached.size());
      stream.features(stream.fed++, features_.data() + row * features);
      reached.push_back({s, stream.fed, row});
    }
  if (reached.empty()) return false;
  team_.run([&](int thread) {
    frame_in_.apply(features_.data(), embedded_.data(), static_cast<std::int64_t>(reached.size()),
                    Store::plain, scratch_[static_cast<std::size_t>(thread)], thread, team_.size());
  });
  for (const Reached& one : reached) {
    const std::int64_t position = time_.length(one.sequence);
    float* x = time_.add(one.sequence);
    std::copy_n(embedded_.data() + one.row * width, width, x);
    add_row(x, time_tables_.position, position, width);
  }
  time_.run();
  remember(reached);
  return true;
}

// Each channel's input for the frames whose state before is reached: those of one sequence come one
// after the other. Without memory only each sequence's newest frame matters.
void FrameDecoder::remember(std::vector<Reached> reached) {
  if (description_.config.memory_layer == 0)
    reached.erase(
        std::remove_if(reached.begin(), reached.end(),
                       [&](const Reached& one) { return one.frame < at(one.sequence).frames(); }),
        reached.end());
  tell_channels(reached);
  for (std::size_t begin = 0, end; begin < reached.size(); begin = end) {
    for (end = begin; end < reached.size() && reached[end].sequence == reached[begin].sequence;)
      ++end;
    remember_sequence(reached, begin, end);
  }
}

// own_ (reached, C, decoder_embd): what the time model tells each channel, and the channel's own
// numbers, read alike for all.
void FrameDecoder::tell_channels(const std::vector<Reached>& reached) {
  const std::int64_t width = time_.width(), features = frame_in_.in();
  for (std::size_t i = 0; i < reached.size(); ++i) {
    float* row = states_.data() + static_cast<std::int64_t>(i) * (width + features);
    time_.final_norm(time_.row(reached[i].row), 1, row);
    if (reached[i].frame > 0)
      at(reached[i].sequence).features(reached[i].frame - 1, row + width);
    else
      std::fill_n(row + width, features, 0.f);
  }
  team_.run([&](int thread) {
    LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)];
    channel_in_.apply(states_.data(), own_.data(), static_cast<std::int64_t>(reached.size()),
                      Store::plain, scratch, thread, team_.size());
    team_.barrier();
    for (auto i = static_cast<std::int64_t>(thread); i < static_cast<std::int64_t>(reached.size());
         i += team_.size())
      add_own(states_.data() + i * (width + features) + width, own_.data() + i * channel_in_.out(),
              scratch);
  });
}

// features (C, kFrameFeatures), own (C, decoder_embd).
void FrameDecoder::add_own(const float* features, float* own, LinearScratch& scratch) const {
  const std::int64_t channels = description_.shape.channels;
  for (std::int64_t c = 0; c < channels; c += kMaxRows)
    own_in_.apply(features + c * kFrameFeatures, own + c * own_in_.out(),
                  std::min(kMaxRows, channels - c), Store::sum, scratch);
}

// Through the memory, channel by channel; keeps what is known of each before the newest frame.
void FrameDecoder::remember_sequence(const std::vector<Reached>& reached, std::size_t begin,
                                     std::size_t end) {
  FrameStreamState& stream = at(reached[begin].sequence);
  const std::int64_t width = memory_.width(), channels = description_.shape.channels;
  const bool newest = reached[end - 1].frame == stream.frames();
  if (newest) stream.own.resize(static_cast<std::size_t>(channels * width));
  std::vector<std::pair<std::int64_t, std::int64_t>> lasts;  // channel, row
  std::int64_t rows = 0;
  const auto run = [&] {
    memory_.run();
    for (const auto& [channel, row] : lasts)
      std::copy_n(memory_.row(row), width, stream.own.data() + channel * width);
    lasts.clear();
    rows = 0;
  };
  for (std::int64_t c = 0; c < channels; ++c)
    for (std::size_t i = begin; i < end; ++i) {
      float* x = memory_.add(reached[i].sequence * channels + c);
      std::copy_n(own_.data() + static_cast<std::int64_t>(i) * channel_in_.out() + c * width, width,
                  x);
      put_past(stream, static_cast<int>(c), reached[i].frame, x);
      if (newest && i + 1 == end) lasts.emplace_back(c, rows);
      if (++rows == kMaxRows) run();
    }
  if (rows > 0) run();
  stream.ready = newest;
}

void FrameDecoder::put_past(const FrameStreamState& stream, int channel, std::int64_t frame,
                            float* x) const {
  const std::int64_t width = memory_.width();
  add_row(x, tables_.channel, channel, width);
  add_row(x, tables_.time, frame, width);
  if (tables_.velocity.empty()) return;
  add_row(x, tables_.velocity, stream.velocity_row(channel, frame), width);
  add_row(x, tables_.last_surprise, stream.last_surprise_row(channel, frame), width);
}

// What was chosen just before it.
void FrameDecoder::put_channel(const FrameStreamState& stream, std::size_t place, float* x) const {
  const std::int64_t width = channels_.width();
  std::copy_n(stream.own.data() + stream.order()[place] * width, width, x);
  add_row(x, tables_.before, stream.before_row(place), width);
  add_row(x, tables_.chosen, stream.before_id(place), width);
  if (tables_.surprise.empty()) return;
  add_row(x, tables_.surprise, stream.before_surprise_row(place), width);
}

void FrameDecoder::run_channels(const Sequences& sequences) {
  const std::int64_t width = channels_.width();
  std::vector<std::pair<std::size_t, std::int64_t>> lasts;  // index of the sequence, its last row
  const auto run = [&] {
    channels_.run();
    for (const auto& [index, row] : lasts)
      std::copy_n(channels_.row(row), width,
                  last_.data() + static_cast<std::int64_t>(index) * width);
    lasts.clear();
  };
  std::int64_t rows = 0;
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    FrameStreamState& stream = at(sequences[i]);
    for (auto place = static_cast<std::size_t>(channels_.length(sequences[i]));
         place <= stream.chosen(); ++place) {
      put_channel(stream, place, channels_.add(sequences[i]));
      if (place == stream.chosen()) lasts.emplace_back(i, rows);
      if (++rows == kMaxRows) run(), rows = 0;
    }
  }
  if (rows > 0) run();
}

}  // namespace mocaplm
