#include "generate/frame_decoder.h"

#include <algorithm>
#include <cassert>

#include "common/error.h"
#include "generate/tables.h"
#include "model/input.h"

namespace mocaplm {

namespace {

std::vector<float> room(std::int64_t rows, std::int64_t width) {
  return std::vector<float>(static_cast<std::size_t>(rows * width));
}

std::int64_t feature_count(const ModelDescription& d) {
  return d.shape.channels * kFrameFeatures;
}

}  // namespace

FrameDecoder::TimeTables::TimeTables(Weights& weights, const ModelDescription& d)
    : token(weights.take("token_embedding", {d.shape.vocabulary, d.config.n_embd})),
      position(weights.take("position_embedding", {d.config.block_size, d.config.n_embd})) {}

FrameDecoder::ChannelTables::ChannelTables(Weights& weights, const ModelDescription& d) {
  const std::int64_t width = d.config.decoder_embd, rows = model_sizes(d).history_rows;
  channel = weights.take("decoder.channel_embedding", {d.shape.channels, width});
  before = weights.take("decoder.before_embedding", {d.shape.channels + 1, width});
  chosen = weights.take("decoder.chosen_embedding", {d.shape.vocabulary, width});
  if (!d.config.history) return;
  surprise = weights.take("decoder.surprise", {rows, width});
  velocity = weights.take("decoder.velocity", {rows, width});
  last_surprise = weights.take("decoder.last_surprise", {rows, width});
}

FrameDecoder::FrameDecoder(const StoredModel& model, const std::string& place,
                           const EngineOptions& options)
    : FrameDecoder(model, place, options, language_tensors(model.tensors)) {}

FrameDecoder::FrameDecoder(const StoredModel& model, const std::string& place,
                           const EngineOptions& options, const TensorMap& tensors)
    : FrameDecoder(model, place, options, Weights(tensors, place + "/model.safetensors")) {}

FrameDecoder::FrameDecoder(const StoredModel& model, const std::string& place,
                           const EngineOptions& options, Weights&& weights)
    : description_(model.description),
      options_(checked(options)),
      team_(options.threads),
      time_tables_(weights, description_),
      frame_in_(packed(weights, "frame_in", description_.config.n_embd, feature_count(description_),
                       options.precision, arena_)),
      time_(weights,
            {"", description_.config.n_layer, description_.config.n_head,
             description_.config.n_embd, description_.config.block_size},
            options_, team_, arena_),
      channel_in_(packed(
          weights, "channel_in", description_.shape.channels * description_.config.decoder_embd,
          description_.config.n_embd + feature_count(description_), options.precision, arena_)),
      own_in_(packed(weights, "decoder.own_in", description_.config.decoder_embd, kFrameFeatures,
                     options.precision, arena_)),
      tables_(weights, description_),
      channels_(weights,
                {"decoder.", description_.config.decoder_layer, description_.config.decoder_head,
                 description_.config.decoder_embd, description_.shape.channels},
                options_, team_, arena_),
      output_(weights, description_, description_.config.decoder_embd, options_, team_, arena_),
      streams_(static_cast<std::size_t>(options_.sequences)) {
  weights.finish();
  time_.followed_by(&channel_in_);
  const std::int64_t wide = description_.config.n_embd, features = feature_count(description_),
                     narrow = description_.config.decoder_embd;
  scratch_.assign(static_cast<std::size_t>(team_.size()), LinearScratch(wide + features));
  features_ = room(kMaxRows, features);
  embedded_ = room(kMaxRows, wide);
  states_ = room(options_.sequences, wide + features);
  own_ = room(options_.sequences, channel_in_.out());
  last_ = normed_ = room(options_.sequences, narrow);
  check(model, place);
}

// The stored windows begin where their clips do, or are long enough that this does not matter.
void FrameDecoder::check(const StoredModel& model, const std::string& place) {
  const std::string file = place + "/selftest.json";
  for (const SelfTestCase& one : model.self_test) {
    check_input(one.input, description_, file);
    const auto frame = std::find_if(one.input.frame.begin(), one.input.frame.end(),
                                    [](std::int32_t f) { return f != 0; });
    const auto prefix = one.input.token.begin() + (frame - one.input.frame.begin());
    begin(0, {one.input.token.begin(), prefix}, {});
    for (auto id = prefix; id != one.input.token.end(); ++id) push(0, *id);
    if (at(0).frame_full()) throw DataError(in_file(file), "a window ends where no bin can follow");
    check_self_test(one, logits({0})[0], file, rounding_tolerance(options_.precision));
  }
}

void FrameDecoder::begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
                         const std::vector<std::int32_t>& before) {
  at(sequence) = FrameStreamState(description_, prefix, before);
  time_.reset(sequence);
  channels_.reset(sequence);
}

void FrameDecoder::set_order(std::int64_t sequence, const std::vector<int>& channels) {
  at(sequence).set_order(channels);
}

void FrameDecoder::push(std::int64_t sequence, std::int32_t id) {
  FrameStreamState& stream = at(sequence);
  if (!stream.frame_full()) {
    stream.choose(id - static_cast<std::int32_t>(description_.shape.first_bin));
    return;
  }
  stream.end_frame();
  channels_.reset(sequence);
  const std::int64_t most = time_.capacity() - static_cast<std::int64_t>(stream.prefix().size());
  if (stream.frames() <= most) return;
  stream.keep(most / 2);
  time_.reset(sequence);
  stream.prefix_fed = false;
  stream.fed = 0;
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
  keep_state(stream, time_.rows() - 1);
}

void FrameDecoder::keep_state(FrameStreamState& stream, std::int64_t row) const {
  stream.state.resize(static_cast<std::size_t>(time_.width()));
  time_.final_norm(time_.row(row), 1, stream.state.data());
}

// As many frames of these sequences as are computed together; false when none is left.
bool FrameDecoder::feed_frames(const Sequences& sequences) {
  std::vector<std::int64_t> owner;  // sequence of each row
  const std::int64_t width = time_.width(), features = feature_count(description_);
  for (const std::int64_t s : sequences)
    for (FrameStreamState& stream = at(s);
         stream.fed < stream.frames() && static_cast<std::int64_t>(owner.size()) < kMaxRows;
         owner.push_back(s))
      stream.features(stream.fed++,
                      features_.data() + static_cast<std::int64_t>(owner.size()) * features);
  if (owner.empty()) return false;
  team_.run([&](int thread) {
    frame_in_.apply(features_.data(), embedded_.data(), static_cast<std::int64_t>(owner.size()),
                    Store::plain, scratch_[static_cast<std::size_t>(thread)], thread, team_.size());
  });
  for (std::size_t r = 0; r < owner.size(); ++r) {
    const std::int64_t position = time_.length(owner[r]);
    float* x = time_.add(owner[r]);
    std::copy_n(embedded_.data() + static_cast<std::int64_t>(r) * width, width, x);
    add_row(x, time_tables_.position, position, width);
  }
  time_.run();
  for (std::size_t r = 0; r < owner.size(); ++r)
    if (r + 1 == owner.size() || owner[r + 1] != owner[r])
      keep_state(at(owner[r]), static_cast<std::int64_t>(r));
  return true;
}

void FrameDecoder::catch_up(const Sequences& sequences) {
  Sequences late;
  for (const std::int64_t s : sequences) {
    if (at(s).ready) continue;
    if (!at(s).prefix_fed) feed_prefix(s);
    late.push_back(s);
  }
  while (feed_frames(late)) {
  }
  if (!late.empty()) prepare_channels(late);
}

void FrameDecoder::prepare_channels(const Sequences& sequences) {
  const std::int64_t width = time_.width(), features = feature_count(description_);
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    const FrameStreamState& stream = at(sequences[i]);
    float* row = states_.data() + static_cast<std::int64_t>(i) * (width + features);
    std::copy(stream.state.begin(), stream.state.end(), row);
    if (stream.frames() > 0)
      stream.features(stream.frames() - 1, row + width);
    else
      std::fill_n(row + width, features, 0.f);
  }
  // What the time model tells each channel, and the channel's own numbers, read alike for all.
  team_.run([&](int thread) {
    LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)];
    channel_in_.apply(states_.data(), own_.data(), static_cast<std::int64_t>(sequences.size()),
                      Store::plain, scratch, thread, team_.size());
    team_.barrier();
    for (std::size_t i = static_cast<std::size_t>(thread); i < sequences.size();
         i += static_cast<std::size_t>(team_.size()))
      add_own(states_.data() + static_cast<std::int64_t>(i) * (width + features) + width,
              own_.data() + static_cast<std::int64_t>(i) * channel_in_.out(), scratch);
  });
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    FrameStreamState& stream = at(sequences[i]);
    const float* row = own_.data() + static_cast<std::int64_t>(i) * channel_in_.out();
    stream.own.assign(row, row + channel_in_.out());
    stream.ready = true;
  }
}

// features (C, kFrameFeatures), own (C, decoder_embd).
void FrameDecoder::add_own(const float* features, float* own, LinearScratch& scratch) const {
  const std::int64_t channels = description_.shape.channels;
  for (std::int64_t c = 0; c < channels; c += kMaxRows)
    own_in_.apply(features + c * kFrameFeatures, own + c * own_in_.out(),
                  std::min(kMaxRows, channels - c), Store::sum, scratch);
}

void FrameDecoder::put_channel(FrameStreamState& stream, std::size_t place, float* x) const {
  const std::int64_t width = channels_.width();
  const int channel = stream.order()[place];
  std::copy_n(stream.own.data() + channel * width, width, x);
  add_row(x, tables_.channel, channel, width);
  add_row(x, tables_.before, stream.before_row(place), width);
  add_row(x, tables_.chosen, stream.before_id(place), width);
  if (tables_.surprise.empty()) return;
  add_row(x, tables_.surprise, stream.before_surprise_row(place), width);
  add_row(x, tables_.velocity, stream.velocity_row(place), width);
  add_row(x, tables_.last_surprise, stream.last_surprise_row(place), width);
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

const std::vector<std::vector<float>>& FrameDecoder::logits(const Sequences& sequences) {
  std::vector<std::int32_t> centre;
  for (const std::int64_t s : sequences) {
    assert(!at(s).frame_full());
    centre.push_back(at(s).centre(at(s).chosen()));
  }
  catch_up(sequences);
  run_channels(sequences);
  channels_.final_norm(last_.data(), static_cast<std::int64_t>(sequences.size()), normed_.data());
  return output_.logits(normed_.data(), centre);
}

}  // namespace mocaplm
