// The joint decoder of a frame model: each joint's past, the joints of a frame, their channels.
#include "model/transformer/frame_transformer.h"

#include <cmath>

namespace mocaplm {

namespace {

// How loud a joint's state still is where its channels read it, as a share.
constexpr double kKeeping = 0.5;

}  // namespace

void FrameTransformer::make_decoder() {
  const ModelConfig& c = description_.config;
  const std::int64_t narrow = c.decoder_embd, bins = description_.shape.bins,
                     features = description_.shape.channels * kFrameFeatures,
                     rows = model_sizes(description_).history_rows, own = kJointChannels;
  joint_in_ = make_linear("joint_in", joints() * narrow, c.n_embd + features,
                          as_embedding(c.n_embd + features));
  own_in_ =
      make_linear("joint.own_in", narrow, own * kFrameFeatures, as_embedding(own * kFrameFeatures));
  joint_.joint = make_table("joint.embedding", joints(), narrow);
  joint_.time = make_table("joint.time_embedding", c.block_size, narrow);
  joint_.before = make_table("joint.before_embedding", joints() + 1, narrow);
  joint_.chosen.bin = make_table("joint.chosen_embedding", 1 + own * bins, narrow);
  channel_in_ = make_linear("channel.in", own * narrow, narrow, kKeeping / std::sqrt(narrow));
  channel_own_in_ =
      make_linear("channel.own_in", narrow, kFrameFeatures, as_embedding(kFrameFeatures));
  channel_.channel = make_table("channel.embedding", description_.shape.channels, narrow);
  channel_.chosen.bin = make_table("channel.chosen_embedding", 1 + (own - 1) * bins, narrow);
  if (c.history) {
    joint_.chosen.surprise = make_table("joint.surprise_embedding", 1 + own * rows, narrow);
    channel_.chosen.surprise =
        make_table("channel.surprise_embedding", 1 + (own - 1) * rows, narrow);
    channel_.velocity = make_table("channel.velocity_embedding", rows, narrow);
    channel_.last_surprise = make_table("channel.last_surprise_embedding", rows, narrow);
  }
  memory_ = make_blocks("joint.memory.", c.memory_layer, narrow);
  decoder_ = make_blocks("joint.decoder.", c.decoder_layer, narrow);
  feed_forward_ = make_feed_forward("channel.", narrow, kFeedForward * narrow);
  last_ln_w_ = make("channel.ln2.weight", {narrow}, 0, 1);
  last_ln_b_ = make("channel.ln2.bias", {narrow}, 0);
}

at::Tensor FrameTransformer::column(const Batch& batch, const at::Tensor& all,
                                    const at::Tensor& places) const {
  return grid(all, batch.prefix, 0).flatten(0, 1).index_select(1, places).flatten();
}

// Row 0 where nothing is known, as of a hidden joint; then each of a joint's channels has its rows.
void FrameTransformer::look_up_chosen(const ChosenTables& tables, const Batch& batch,
                                      const at::Tensor& places, std::int64_t which,
                                      const at::Tensor& known, std::vector<Lookup>& lookups) const {
  const StreamShape& shape = description_.shape;
  const std::int64_t frames = batch.token.size(0) * frames_decoded(batch);
  const at::Tensor bin = column(batch, batch.token, places).view({frames, -1, 1}) - shape.first_bin;
  const at::Tensor there =
      known.view({1, places.size(0), -1}) * (bin >= 0).logical_and(bin < shape.bins).to(at::kLong);
  const auto rows = [&](const at::Tensor& row, std::int64_t each) {
    return ((row.view({frames, -1, 1}) + (1 + which * each)) * there).flatten();
  };
  lookups.push_back({tables.bin, rows(bin, shape.bins)});
  if (tables.surprise.defined())
    lookups.push_back({tables.surprise, rows(column(batch, batch.surprise, places),
                                             model_sizes(description_).history_rows)});
}

at::Tensor FrameTransformer::features_before(const Batch& batch) const {
  return at::constant_pad_nd(whole_frames(batch), {0, 0, 1, 0});
}

at::Tensor FrameTransformer::joint_past(const at::Tensor& hidden, const at::Tensor& features,
                                        const Batch& batch) const {
  const std::int64_t narrow = description_.config.decoder_embd, size = batch.token.size(0),
                     frames = frames_decoded(batch);
  const at::Tensor state = hidden.slice(1, batch.prefix - 1, batch.prefix - 1 + frames);
  // What the time model tells each joint, and the joint's own numbers, read alike for all.
  const at::Tensor own =
      output_linear(joint_in_, at::cat({state, features}, 2).flatten(0, 1), precision_)
          .view({-1, narrow}) +
      output_linear(own_in_, features.view({-1, kJointChannels * kFrameFeatures}), precision_);
  const at::Tensor joint = at::arange(joints(), hidden.options().dtype(at::kLong));
  const std::vector<Lookup> lookups = {
      {joint_.joint, joint.repeat({size * frames})},
      {joint_.time,
       at::arange(frames, joint.options()).repeat_interleave(joints()).repeat({size})}};
  const at::Tensor x = drop(embedding_sum(own, lookups)).view({size, frames, joints(), narrow});
  if (memory_.empty()) return x;
  const at::Tensor past = run_blocks(memory_, x.transpose(1, 2).reshape({-1, frames, narrow}),
                                     description_.config.decoder_head, 0);
  return past.view({size, joints(), frames, narrow}).transpose(1, 2);
}

at::Tensor FrameTransformer::joint_states(const at::Tensor& hidden, const at::Tensor& features,
                                          const Batch& batch, const at::Tensor& order) const {
  const std::int64_t narrow = description_.config.decoder_embd;
  const at::Tensor past = joint_past(hidden, features, batch).reshape({-1, joints(), narrow});
  const at::Tensor none = at::zeros({1}, order.options());
  const at::Tensor before = at::cat({none, order.slice(0, 0, -1) + 1});
  std::vector<Lookup> lookups = {{joint_.before, before.repeat({past.size(0)})}};
  // A token's column lies one behind its channel.
  for (std::int64_t k = 0; k < kJointChannels; ++k)
    look_up_chosen(joint_.chosen, batch,
                   at::cat({none, order.slice(0, 0, -1) * kJointChannels + k + 1}), k,
                   (before > 0).to(at::kLong), lookups);
  // Most often the order is the stream's: then nothing needs to be moved.
  const bool moved = !order.equal(at::arange(joints(), order.options()));
  const at::Tensor base = moved ? past.index_select(1, order) : past;
  const at::Tensor x = embedding_sum(base.flatten(0, 1), lookups).view(base.sizes());
  return run_blocks(decoder_, x, description_.config.decoder_head, 0);
}

at::Tensor FrameTransformer::decode(const at::Tensor& hidden, const Batch& batch,
                                    const at::Tensor& order) const {
  const std::int64_t narrow = description_.config.decoder_embd;
  const at::Tensor before = features_before(batch), channels = channels_of(order);
  const at::Tensor joint = joint_states(hidden, before, batch, order);
  const at::Tensor features = before.view({joint.size(0), -1, kFrameFeatures})
                                  .index_select(1, channels)
                                  .view({-1, kFrameFeatures});
  const at::Tensor own =
      output_linear(channel_in_, joint.reshape({-1, narrow}), precision_).view({-1, narrow}) +
      output_linear(channel_own_in_, features, precision_);
  std::vector<Lookup> lookups = {{channel_.channel, channels.repeat({joint.size(0)})}};
  if (channel_.velocity.defined()) {
    lookups.push_back({channel_.velocity, column(batch, batch.velocity, channels)});
    lookups.push_back({channel_.last_surprise, column(batch, batch.last_surprise, channels)});
  }
  const at::Tensor channel = at::arange(kJointChannels, order.options());
  for (std::int64_t k = 0; k + 1 < kJointChannels; ++k)
    look_up_chosen(channel_.chosen, batch, order * kJointChannels + k + 1, k,
                   (channel > k).to(at::kLong).repeat({joints()}), lookups);
  const at::Tensor x = feed_forward(feed_forward_, drop(embedding_sum(own, lookups)), precision_);
  return at::layer_norm(x, {narrow}, last_ln_w_, last_ln_b_);
}

}  // namespace mocaplm
