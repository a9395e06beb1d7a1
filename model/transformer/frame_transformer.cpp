#include "model/transformer/frame_transformer.h"

#include <cmath>

#include "model/transformer/embedding_sum.h"

namespace mocaplm {

namespace {

// A logit that leaves nothing of a probability.
constexpr double kNever = -1e4;

// Of each frame, what `x` (B, F, C) was `frames` frames before; 0 where that is before the window.
at::Tensor shifted(const at::Tensor& x, std::int64_t frames) {
  if (frames == 0) return x;
  const std::int64_t kept = std::max<std::int64_t>(x.size(1) - frames, 0);
  return at::constant_pad_nd(x.slice(1, 0, kept), {0, 0, x.size(1) - kept, 0});
}

// x[t] - x[t-1] from the frame `first` on, 0 before.
at::Tensor change(const at::Tensor& x, std::int64_t first) {
  at::Tensor out = at::zeros_like(x);
  if (x.size(1) > first) out.slice(1, first).copy_(x.slice(1, first) - x.slice(1, first - 1, -1));
  return out;
}

}  // namespace

at::Tensor frame_features(const at::Tensor& bin, std::int64_t bins) {
  const at::NoGradGuard no_grad;
  const at::Tensor x = bin.to(at::kFloat);
  const at::Tensor u = (2 * x + 1) / static_cast<double>(bins) - 1;
  std::vector<at::Tensor> parts = {u};
  for (const double times : {1., 2., 4.}) {
    parts.push_back(at::sin(u * (times * M_PI)));
    parts.push_back(at::cos(u * (times * M_PI)));
  }
  const at::Tensor step = change(x, 1), turn = change(step, 2);
  parts.push_back(at::asinh(step) * 0.5);
  const at::Tensor wide = at::asinh(turn) * 0.5;
  parts.push_back(wide);
  parts.push_back(shifted(wide, 1));
  const at::Tensor fine = turn.clamp(-kMostChange, kMostChange) * 0.25;
  for (std::int64_t lag = 0; lag < kFrameLags; ++lag) parts.push_back(shifted(fine, lag));
  return at::stack(parts, 3).flatten(2);
}

FrameTransformer::FrameTransformer(const ModelDescription& description)
    : LanguageModel(description) {
  const ModelConfig& c = description.config;
  const std::int64_t channels = description.shape.channels,
                     vocabulary = description.shape.vocabulary,
                     features = channels * kFrameFeatures, narrow = c.decoder_embd;
  token_ = make_table("token_embedding", vocabulary, c.n_embd);
  position_ = make_table("position_embedding", c.block_size, c.n_embd);
  frame_in_ = make_linear("frame_in", c.n_embd, features);
  blocks_ = make_blocks("block.", c.n_layer, c.n_embd);
  ln_w_ = make("ln.weight", {c.n_embd}, 0, 1);
  ln_b_ = make("ln.bias", {c.n_embd}, 0);
  channel_in_ = make_linear("channel_in", channels * narrow, c.n_embd + features);
  own_in_ = make_linear("decoder.own_in", narrow, kFrameFeatures);
  channel_ = make_table("decoder.channel_embedding", channels, narrow);
  before_ = make_table("decoder.before_embedding", channels + 1, narrow);
  chosen_ = make_table("decoder.chosen_embedding", vocabulary, narrow);
  if (c.history) {
    const std::int64_t rows = model_sizes(description).history_rows;
    surprise_ = make_table("decoder.surprise", rows, narrow);
    velocity_ = make_table("decoder.velocity", rows, narrow);
    last_surprise_ = make_table("decoder.last_surprise", rows, narrow);
  }
  decoder_ = make_blocks("decoder.block.", c.decoder_layer, narrow);
  decoder_ln_w_ = make("decoder.ln.weight", {narrow}, 0, 1);
  decoder_ln_b_ = make("decoder.ln.bias", {narrow}, 0);
  make_output(narrow);
}

at::Tensor FrameTransformer::grid(const at::Tensor& column, std::int64_t prefix,
                                  std::int64_t rest) const {
  const std::int64_t per_frame = description_.shape.tokens_per_frame();
  const at::Tensor from = column.slice(1, prefix - 1);
  const std::int64_t frames = (from.size(1) - 1) / per_frame + 1;
  return at::constant_pad_nd(from, {0, frames * per_frame - from.size(1)}, rest)
      .view({column.size(0), frames, per_frame});
}

std::int64_t FrameTransformer::frames_decoded(const Batch& batch) const {
  return (batch.token.size(1) - batch.prefix) / description_.shape.tokens_per_frame() + 1;
}

at::Tensor FrameTransformer::whole_frames(const Batch& batch) const {
  const StreamShape& shape = description_.shape;
  const std::int64_t per_frame = shape.tokens_per_frame(), prefix = batch.prefix;
  const std::int64_t frames = (batch.token.size(1) - prefix) / per_frame;
  const at::Tensor bin = batch.token.slice(1, prefix, prefix + frames * per_frame)
                             .reshape({batch.token.size(0), frames, per_frame})
                             .slice(2, 0, shape.channels) -
                         shape.first_bin;
  return frame_features(bin.clamp(0, shape.bins - 1), shape.bins);
}

at::Tensor FrameTransformer::hidden(const Batch& batch, const at::Tensor& extra) {
  const std::int64_t size = batch.token.size(0), width = description_.config.n_embd;
  const at::Tensor features = whole_frames(batch);
  at::Tensor x = at::embedding(token_, batch.token.slice(1, 0, batch.prefix));
  if (features.size(1) > 0)
    x = at::cat({x, output_linear(frame_in_, features.flatten(0, 1), precision_)
                        .view({size, features.size(1), width})},
                1);
  x = drop(x + position_.slice(0, 0, x.size(1)));
  const std::int64_t free = extra.defined() ? extra.size(1) : 0;
  if (free > 0) x = at::cat({x, extra}, 1);
  x = run_blocks(blocks_, x, description_.config.n_head, free);
  return at::layer_norm(x, {width}, ln_w_, ln_b_);
}

at::Tensor FrameTransformer::fixed_order(const at::Device& device) const {
  return (order_.empty() ? at::arange(description_.shape.channels, at::kLong)
                         : at::tensor(order_, at::kLong))
      .to(device);
}

// Joints are groups of three channels, each first with the same drawn probability.
at::Tensor FrameTransformer::draw_order() const {
  const std::int64_t channels = description_.shape.channels;
  if (at::rand({1}).item<double>() >= description_.config.shown_first)
    return at::arange(channels, at::kLong);
  const at::Tensor later = (at::rand({(channels + 2) / 3}) > at::rand({1})).to(at::kLong);
  const at::Tensor rank = at::repeat_interleave(later, 3).slice(0, 0, channels) * channels +
                          at::arange(channels, at::kLong);
  return at::argsort(rank);
}

at::Tensor FrameTransformer::decode(const at::Tensor& hidden, const Batch& batch,
                                    const at::Tensor& order) const {
  const std::int64_t channels = description_.shape.channels,
                     narrow = description_.config.decoder_embd;
  const std::int64_t frames = frames_decoded(batch);
  // The state before each frame, and the features of the frame before it.
  const at::Tensor state = hidden.slice(1, batch.prefix - 1, batch.prefix - 1 + frames);
  const at::Tensor features = at::constant_pad_nd(whole_frames(batch), {0, 0, 1, 0});
  // What the time model tells each channel, and the channel's own numbers, read alike for all.
  const at::Tensor own =
      (output_linear(channel_in_, at::cat({state, features}, 2).flatten(0, 1), precision_)
           .view({-1, narrow}) +
       output_linear(own_in_, features.view({-1, kFrameFeatures}), precision_))
          .view({-1, channels, narrow});
  // A column of the grid lies before its channel and behind the one before it in the stream.
  const at::Tensor behind = at::cat({at::zeros({1}, order.options()), order.slice(0, 0, -1) + 1});
  const auto column = [&](const at::Tensor& all, const at::Tensor& at) {
    return grid(all, batch.prefix, 0).flatten(0, 1).index_select(1, at).flatten();
  };
  const auto every_frame = [&](const at::Tensor& at) { return at.repeat({own.size(0)}); };
  std::vector<Lookup> lookups = {{channel_, every_frame(order)},
                                 {before_, every_frame(behind)},
                                 {chosen_, column(batch.token, behind)}};
  if (surprise_.defined()) {
    lookups.push_back({surprise_, column(batch.surprise, behind)});
    lookups.push_back({velocity_, column(batch.velocity, order)});
    lookups.push_back({last_surprise_, column(batch.last_surprise, order)});
  }
  // Most often the order is the stream's: then nothing needs to be moved.
  const bool moved = !order.equal(at::arange(channels, order.options()));
  const at::Tensor base = moved ? own.index_select(1, order) : own;
  at::Tensor x = embedding_sum(base.flatten(0, 1), lookups).view(base.sizes());
  x = run_blocks(decoder_, drop(x), description_.config.decoder_head, 0);
  return at::layer_norm(x, {narrow}, decoder_ln_w_, decoder_ln_b_).flatten(0, 1);
}

at::Tensor FrameTransformer::logits(const at::Tensor& hidden, const Batch& batch) {
  const StreamShape& shape = description_.shape;
  const at::Tensor order = fixed_order(hidden.device());
  const at::Tensor centre = grid(batch.centre, batch.prefix, kNoCentre).index_select(2, order);
  const std::int64_t size = centre.size(0), frames = centre.size(1);
  const at::Tensor bins = output_logits(decode(hidden, batch, order), centre.reshape({-1}))
                              .view({size, frames, shape.channels, -1})
                              .index_select(2, at::argsort(order));
  // After the last channel comes the separator, certainly.
  at::Tensor end = at::full({size, frames, 1, bins.size(3)}, kNever, bins.options());
  end.select(3, shape.first_bin - 1).zero_();
  const at::Tensor all = at::cat({bins, end}, 2).flatten(1, 2);
  const std::int64_t before = batch.prefix - 1;
  return at::constant_pad_nd(all.slice(1, 0, batch.token.size(1) - before), {0, 0, before, 0});
}

at::Tensor FrameTransformer::loss(const at::Tensor& hidden, const Batch& batch) {
  const at::Tensor order =
      is_training() ? draw_order().to(hidden.device()) : fixed_order(hidden.device());
  const at::Tensor centre = grid(batch.centre, batch.prefix, kNoCentre).index_select(2, order),
                   target = grid(batch.target, batch.prefix, -1).index_select(2, order);
  const at::Tensor nats =
      output_loss(decode(hidden, batch, order), centre.reshape({-1}), target.reshape({-1}))
          .view(centre.sizes())
          .index_select(2, at::argsort(order));
  const std::int64_t before = batch.prefix - 1;
  const at::Tensor all = at::constant_pad_nd(nats, {0, 1}).flatten(1, 2);
  return at::constant_pad_nd(all.slice(1, 0, batch.token.size(1) - before), {before, 0});
}

}  // namespace mocaplm
