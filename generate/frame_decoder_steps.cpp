// The steps of a frame decoder: frames through the time model, each joint's past, the joints of the
// frame in the making.
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

// Each joint's input for the frames whose state before is reached: those of one sequence come one
// after the other. Without memory only each sequence's newest frame matters.
void FrameDecoder::remember(std::vector<Reached> reached) {
  if (description_.config.memory_layer == 0)
    reached.erase(
        std::remove_if(reached.begin(), reached.end(),
                       [&](const Reached& one) { return one.frame < at(one.sequence).frames(); }),
        reached.end());
  tell_joints(reached);
  for (std::size_t begin = 0, end; begin < reached.size(); begin = end) {
    for (end = begin; end < reached.size() && reached[end].sequence == reached[begin].sequence;)
      ++end;
    remember_sequence(reached, begin, end);
  }
}

// own_ (reached, J, decoder_embd): what the time model tells each joint, and the joint's own
// numbers, read alike for all.
void FrameDecoder::tell_joints(const std::vector<Reached>& reached) {
  const std::int64_t width = time_.width(), features = frame_in_.in();
  for (std::size_t i = 0; i < reached.size(); ++i) {
    FrameStreamState& stream = at(reached[i].sequence);
    float* row = states_.data() + static_cast<std::int64_t>(i) * (width + features);
    time_.final_norm(time_.row(reached[i].row), 1, row);
    if (reached[i].frame > 0)
      stream.features(reached[i].frame - 1, row + width);
    else
      std::fill_n(row + width, features, 0.f);
    if (reached[i].frame == stream.frames()) channels_.begin_frame(stream, row + width);
  }
  const auto rows = static_cast<std::int64_t>(reached.size());
  team_.run([&](int thread) {
    LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)];
    joint_in_.apply(states_.data(), own_.data(), rows, Store::plain, scratch, thread, team_.size());
    team_.barrier();
    for (auto i = static_cast<std::int64_t>(thread); i < rows; i += team_.size())
      for (std::int64_t j = 0; j < joints(); j += kMaxRows)
        own_in_.apply(states_.data() + i * (width + features) + width + j * own_in_.in(),
                      own_.data() + i * joint_in_.out() + j * own_in_.out(),
                      std::min(kMaxRows, joints() - j), Store::sum, scratch);
  });
}

// Through the memory, joint by joint; keeps what is known of each before the newest frame.
void FrameDecoder::remember_sequence(const std::vector<Reached>& reached, std::size_t begin,
                                     std::size_t end) {
  FrameStreamState& stream = at(reached[begin].sequence);
  const std::int64_t width = memory_.width();
  const bool newest = reached[end - 1].frame == stream.frames();
  if (newest) stream.joints.resize(static_cast<std::size_t>(joints() * width));
  std::vector<std::pair<std::int64_t, std::int64_t>> lasts;  // joint, row
  std::int64_t rows = 0;
  const auto run = [&] {
    memory_.run();
    for (const auto& [joint, row] : lasts)
      std::copy_n(memory_.row(row), width, stream.joints.data() + joint * width);
    lasts.clear();
    rows = 0;
  };
  for (std::int64_t j = 0; j < joints(); ++j)
    for (std::size_t i = begin; i < end; ++i) {
      float* x = memory_.add(reached[i].sequence * joints() + j);
      std::copy_n(own_.data() + static_cast<std::int64_t>(i) * joint_in_.out() + j * width, width,
                  x);
      add_row(x, tables_.joint, j, width);
      add_row(x, tables_.time, reached[i].frame, width);
      if (newest && i + 1 == end) lasts.emplace_back(j, rows);
      if (++rows == kMaxRows) run();
    }
  if (rows > 0) run();
  stream.ready = newest;
}

// What was chosen just before it.
void FrameDecoder::put_joint(const FrameStreamState& stream, std::size_t place, float* x) const {
  const std::int64_t width = joints_.width(), rows = model_sizes(description_).history_rows;
  std::copy_n(stream.joints.data() + stream.joint(place) * width, width, x);
  const bool known = place > 0;
  const int before = known ? stream.joint(place - 1) : 0;
  add_row(x, tables_.before, known ? before + 1 : 0, width);
  for (int k = 0; k < kJointChannels; ++k) {
    const int channel = before * static_cast<int>(kJointChannels) + k;
    add_row(x, tables_.chosen,
            known ? 1 + k * description_.shape.bins + stream.chosen_bin(channel) : 0, width);
    if (!tables_.surprise.empty())
      add_row(x, tables_.surprise, known ? 1 + k * rows + stream.surprise_row(channel) : 0, width);
  }
}

void FrameDecoder::run_joints(const Sequences& sequences) {
  const std::int64_t width = joints_.width();
  std::vector<FrameStreamState*> begun;  // streams whose next joint is new, their states in last_
  std::vector<std::pair<std::size_t, std::int64_t>> lasts;  // index in `begun`, its last row
  const auto run = [&] {
    joints_.run();
    for (const auto& [index, row] : lasts)
      std::copy_n(joints_.row(row), width, last_.data() + static_cast<std::int64_t>(index) * width);
    lasts.clear();
  };
  std::int64_t rows = 0;
  for (const std::int64_t s : sequences) {
    FrameStreamState& stream = at(s);
    const std::size_t next = stream.chosen() / kJointChannels;
    for (auto place = static_cast<std::size_t>(joints_.length(s)); place <= next; ++place) {
      put_joint(stream, place, joints_.add(s));
      if (place == next) {
        lasts.emplace_back(begun.size(), rows);
        begun.push_back(&stream);
      }
      if (++rows == kMaxRows) run(), rows = 0;
    }
  }
  if (rows > 0) run();
  if (!begun.empty()) channels_.begin_joints(begun, last_.data());
}

}  // namespace mocaplm
