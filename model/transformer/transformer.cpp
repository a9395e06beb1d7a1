#include "model/transformer/transformer.h"

namespace mocaplm {

Transformer::Transformer(const ModelDescription& description) : LanguageModel(description) {
  const ModelConfig& c = description.config;
  const ModelSizes sizes = model_sizes(description);
  const std::int64_t width = c.n_embd;
  token_ = make_table("token_embedding", description.shape.vocabulary, width);
  if (c.position == "custom") {
    frame_ = make_table("frame_embedding", sizes.frame_positions, width);
    channel_ = make_table("channel_embedding", sizes.channel_positions, width);
  } else {
    position_ = make_table("position_embedding", c.block_size, width);
  }
  if (c.history) {
    surprise_ = make_table("history.surprise", sizes.history_rows, width);
    velocity_ = make_table("history.velocity", sizes.history_rows, width);
    last_surprise_ = make_table("history.last_surprise", sizes.history_rows, width);
  }
  blocks_ = make_blocks("block.", c.n_layer, width);
  ln_w_ = make("ln.weight", {width}, 0, 1);
  ln_b_ = make("ln.bias", {width}, 0);
  make_output(width);
}

at::Tensor Transformer::embed(const Batch& batch) const {
  at::Tensor x = at::embedding(token_, batch.token);
  if (position_.defined())
    x = x + position_.slice(0, 0, batch.token.size(1));
  else
    x = x + at::embedding(frame_, batch.frame) + at::embedding(channel_, batch.channel);
  if (surprise_.defined())
    x = x + at::embedding(surprise_, batch.surprise) + at::embedding(velocity_, batch.velocity) +
        at::embedding(last_surprise_, batch.last_surprise);
  return x;
}

at::Tensor Transformer::hidden(const Batch& batch, const at::Tensor& extra) {
  at::Tensor x = drop(embed(batch));
  const std::int64_t added = extra.defined() ? extra.size(1) : 0;
  if (added > 0) x = at::cat({x, extra}, 1);
  const std::int64_t free = description_.masked() ? x.size(1) : added;
  x = run_blocks(blocks_, x, description_.config.n_head, free);
  return at::layer_norm(x, {x.size(2)}, ln_w_, ln_b_);
}

at::Tensor Transformer::logits(const at::Tensor& hidden, const Batch& batch) {
  return output_logits(hidden.flatten(0, 1), batch.centre.flatten())
      .view({hidden.size(0), hidden.size(1), -1});
}

at::Tensor Transformer::loss(const at::Tensor& hidden, const Batch& batch) {
  return output_loss(hidden.flatten(0, 1), batch.centre.flatten(), batch.target.flatten())
      .view({hidden.size(0), hidden.size(1)});
}

}  // namespace mocaplm
