#include "model/transformer/frame_transformer.h"

#include <cmath>

#include "model/transformer/frame_features.h"

namespace mocaplm {

namespace {

// A logit that leaves nothing of a probability.
constexpr double kNever = -1e4;

}  // namespace

// The deviation of fresh weights with which a linear layer starts as loud as the embeddings that
// are added to it, rather than drowning them.
double FrameTransformer::as_embedding(std::int64_t inputs) {
  return kDeviation / std::sqrt(static_cast<double>(inputs));
}

FrameTransformer::FrameTransformer(const ModelDescription& description)
    : LanguageModel(description) {
  const ModelConfig& c = description.config;
  const std::int64_t features = description.shape.channels * kFrameFeatures;
  token_ = make_table("token_embedding", description.shape.vocabulary, c.n_embd);
  position_ = make_table("position_embedding", c.block_size, c.n_embd);
  frame_in_ = make_linear("frame_in", c.n_embd, features, as_embedding(features));
  blocks_ = make_blocks("block.", c.n_layer, c.n_embd);
  ln_w_ = make("ln.weight", {c.n_embd}, 0, 1);
  ln_b_ = make("ln.bias", {c.n_embd}, 0);
  make_decoder();
  make_output(c.decoder_embd);
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
  return frame_features(bin, shape.bins);
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
  return (order_.empty() ? at::arange(joints(), at::kLong) : at::tensor(order_, at::kLong))
      .to(device);
}

// Each joint comes first with the same drawn probability.
at::Tensor FrameTransformer::draw_order() const {
  const at::Tensor joint = at::arange(joints(), at::kLong);
  if (at::rand({1}).item<double>() >= description_.config.shown_first) return joint;
  const at::Tensor later = (at::rand({joints()}) > at::rand({1})).to(at::kLong);
  return at::argsort(later * joints() + joint);
}

at::Tensor FrameTransformer::channels_of(const at::Tensor& order) {
  return (order.unsqueeze(1) * kJointChannels + at::arange(kJointChannels, order.options()))
      .flatten();
}

at::Tensor FrameTransformer::logits(const at::Tensor& hidden, const Batch& batch) {
  const StreamShape& shape = description_.shape;
  const at::Tensor order = fixed_order(hidden.device()), channels = channels_of(order);
  const at::Tensor centre = grid(batch.centre, batch.prefix, kNoCentre).index_select(2, channels);
  const std::int64_t size = centre.size(0), frames = centre.size(1);
  const at::Tensor bins = output_logits(decode(hidden, batch, order), centre.reshape({-1}))
                              .view({size, frames, shape.channels, -1})
                              .index_select(2, at::argsort(channels));
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
  const at::Tensor channels = channels_of(order);
  const at::Tensor centre = grid(batch.centre, batch.prefix, kNoCentre).index_select(2, channels),
                   target = grid(batch.target, batch.prefix, -1).index_select(2, channels);
  const at::Tensor nats =
      output_loss(decode(hidden, batch, order), centre.reshape({-1}), target.reshape({-1}))
          .view(centre.sizes())
          .index_select(2, at::argsort(channels));
  const std::int64_t before = batch.prefix - 1;
  const at::Tensor all = at::constant_pad_nd(nats, {0, 1}).flatten(1, 2);
  return at::constant_pad_nd(all.slice(1, 0, batch.token.size(1) - before), {before, 0});
}

}  // namespace mocaplm
