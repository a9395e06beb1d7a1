#include "generate/channel_layer.h"

#include <algorithm>

#include "generate/tables.h"
#include "model/input.h"

namespace mocaplm {

namespace {

constexpr auto kPlaces = static_cast<int>(kJointChannels);

}  // namespace

ChannelLayer::ChannelLayer(Weights& weights, const ModelDescription& d,
                           const EngineOptions& options, Team& team, Arena& arena)
    : width_(d.config.decoder_embd),
      bins_(d.shape.bins),
      channels_(d.shape.channels),
      history_rows_(model_sizes(d).history_rows),
      team_(team),
      in_(packed(weights, "channel.in", kPlaces * width_, width_, options.precision, arena)),
      own_in_(packed(weights, "channel.own_in", width_, kFrameFeatures, options.precision, arena)),
      up_(packed(weights, "channel.up", kFeedForward * width_, width_, options.precision, arena)),
      down_(
          packed(weights, "channel.down", width_, kFeedForward * width_, options.precision, arena)),
      ln1_w_(weights.take("channel.ln1.weight", {width_})),
      ln1_b_(weights.take("channel.ln1.bias", {width_})),
      ln2_w_(weights.take("channel.ln2.weight", {width_})),
      ln2_b_(weights.take("channel.ln2.bias", {width_})),
      output_(weights, d, width_, options, team, arena),
      scratch_(static_cast<std::size_t>(team.size()), LinearScratch(kFeedForward * width_)),
      x_(static_cast<std::size_t>(options.sequences * width_)),
      normed_(x_.size()),
      wide_(x_.size() * kFeedForward),
      told_(x_.size() * kPlaces) {
  tables_.channel = weights.take("channel.embedding", {channels_, width_});
  tables_.chosen = weights.take("channel.chosen_embedding", {1 + (kPlaces - 1) * bins_, width_});
  if (!d.config.history) return;
  tables_.surprise =
      weights.take("channel.surprise_embedding", {1 + (kPlaces - 1) * history_rows_, width_});
  tables_.velocity = weights.take("channel.velocity_embedding", {history_rows_, width_});
  tables_.last_surprise = weights.take("channel.last_surprise_embedding", {history_rows_, width_});
}

void ChannelLayer::begin_frame(FrameStreamState& stream, const float* features) {
  stream.channels.resize(static_cast<std::size_t>(channels_ * width_));
  for (std::int64_t c = 0; c < channels_; c += kMaxRows)
    own_in_.apply(features + c * kFrameFeatures, stream.channels.data() + c * width_,
                  std::min(kMaxRows, channels_ - c), Store::plain, scratch_[0]);
  for (std::int64_t c = 0; c < channels_; ++c) {
    float* x = stream.channels.data() + c * width_;
    const auto channel = static_cast<int>(c);
    add_row(x, tables_.channel, c, width_);
    if (tables_.velocity.empty()) continue;
    add_row(x, tables_.velocity, stream.velocity_row(channel, stream.frames()), width_);
    add_row(x, tables_.last_surprise, stream.last_surprise_row(channel, stream.frames()), width_);
  }
}

void ChannelLayer::begin_joints(const std::vector<FrameStreamState*>& streams,
                                const float* states) {
  const auto rows = static_cast<std::int64_t>(streams.size());
  team_.run([&](int thread) {
    in_.apply(states, told_.data(), rows, Store::plain, scratch_[static_cast<std::size_t>(thread)],
              thread, team_.size());
  });
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const float* told = told_.data() + static_cast<std::int64_t>(i) * in_.out();
    streams[i]->told.assign(told, told + in_.out());
  }
}

// What the next channel is told: row 0 stands for what is not chosen yet.
void ChannelLayer::put(const FrameStreamState& stream, float* x) const {
  const int channel = stream.order()[stream.chosen()], place = channel % kPlaces;
  const float* own = stream.channels.data() + channel * width_;
  const float* told = stream.told.data() + place * width_;
  for (std::int64_t i = 0; i < width_; ++i) x[i] = told[i] + own[i];
  for (int k = 0; k + 1 < kPlaces; ++k) {
    const int earlier = channel - place + k;
    add_row(x, tables_.chosen, k < place ? 1 + k * bins_ + stream.chosen_bin(earlier) : 0, width_);
    if (tables_.surprise.empty()) continue;
    add_row(x, tables_.surprise,
            k < place ? 1 + k * history_rows_ + stream.surprise_row(earlier) : 0, width_);
  }
}

const std::vector<std::vector<float>>& ChannelLayer::logits(
    const std::vector<FrameStreamState*>& streams) {
  const auto rows = static_cast<std::int64_t>(streams.size());
  std::vector<std::int32_t> centre;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    put(*streams[i], x_.data() + static_cast<std::int64_t>(i) * width_);
    centre.push_back(streams[i]->centre(streams[i]->chosen()));
  }
  kernels().layer_norm(x_.data(), ln1_w_.data(), ln1_b_.data(), rows, width_, normed_.data());
  team_.run([&](int thread) {
    LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)];
    up_.apply(normed_.data(), wide_.data(), rows, Store::gelu, scratch, thread, team_.size());
    team_.barrier();
    down_.apply(wide_.data(), x_.data(), rows, Store::sum, scratch, thread, team_.size());
  });
  kernels().layer_norm(x_.data(), ln2_w_.data(), ln2_b_.data(), rows, width_, normed_.data());
  return output_.logits(normed_.data(), centre);
}

}  // namespace mocaplm
