#include "model/transformer/transformer.h"

#include <algorithm>
#include <cmath>

#include "model/transformer/dropout.h"

namespace mocaplm {

namespace {

constexpr double kDeviation = 0.02;

// LibTorch keeps dots in names for nested modules.
std::string parameter_name(std::string name) {
  std::replace(name.begin(), name.end(), '.', '/');
  return name;
}

at::Tensor rows(const std::vector<ModelInput>& inputs,
                std::vector<std::int32_t> ModelInput::*member) {
  const auto length = static_cast<std::int64_t>(inputs.front().size());
  at::Tensor out = at::empty({static_cast<std::int64_t>(inputs.size()), length}, at::kLong);
  auto* values = out.data_ptr<std::int64_t>();
  for (const ModelInput& input : inputs)
    for (const std::int32_t value : input.*member) *values++ = value;
  return out;
}

}  // namespace

Batch Batch::to(const at::Device& device) const {
  if (device.is_cpu()) return *this;
  Batch moved;
  for (auto member : {&Batch::token, &Batch::frame, &Batch::channel, &Batch::centre,
                      &Batch::surprise, &Batch::velocity, &Batch::last_surprise, &Batch::target})
    if ((this->*member).defined()) moved.*member = (this->*member).to(device);
  return moved;
}

Batch stack(const std::vector<ModelInput>& inputs,
            const std::vector<std::vector<std::int32_t>>& targets) {
  Batch batch;
  batch.token = rows(inputs, &ModelInput::token);
  batch.frame = rows(inputs, &ModelInput::frame);
  batch.channel = rows(inputs, &ModelInput::channel);
  batch.centre = rows(inputs, &ModelInput::centre);
  batch.surprise = rows(inputs, &ModelInput::surprise);
  batch.velocity = rows(inputs, &ModelInput::velocity);
  batch.last_surprise = rows(inputs, &ModelInput::last_surprise);
  if (targets.empty()) return batch;
  batch.target = at::empty_like(batch.token);
  auto* values = batch.target.data_ptr<std::int64_t>();
  for (const auto& target : targets)
    for (const std::int32_t id : target) *values++ = id;
  return batch;
}

at::Tensor Transformer::make(const std::string& name, at::IntArrayRef shape, double deviation,
                             double mean) {
  at::Tensor value = at::full(shape, mean, at::kFloat);
  if (deviation > 0) value.normal_(mean, deviation);
  return register_parameter(parameter_name(name), value);
}

LinearWeights Transformer::make_linear(const std::string& name, std::int64_t out, std::int64_t in,
                                       double deviation) {
  LinearWeights linear;
  linear.weight = make(name + ".weight", {out, in}, deviation);
  linear.bias = make(name + ".bias", {out}, 0);
  return linear;
}

Transformer::Transformer(const ModelDescription& description) : description_(description) {
  check_model(description);
  const ModelConfig& c = description.config;
  const ModelSizes sizes = model_sizes(description);
  const std::int64_t width = c.n_embd;
  token_ = make("token_embedding", {description.shape.vocabulary, width}, kDeviation);
  if (c.position == "custom") {
    frame_ = make("frame_embedding", {sizes.frame_positions, width}, kDeviation);
    channel_ = make("channel_embedding", {sizes.channel_positions, width}, kDeviation);
  } else {
    position_ = make("position_embedding", {c.block_size, width}, kDeviation);
  }
  if (c.history) {
    surprise_ = make("history.surprise", {sizes.history_rows, width}, kDeviation);
    velocity_ = make("history.velocity", {sizes.history_rows, width}, kDeviation);
    last_surprise_ = make("history.last_surprise", {sizes.history_rows, width}, kDeviation);
  }
  const double residual = kDeviation / std::sqrt(2.0 * static_cast<double>(c.n_layer));
  for (std::int64_t i = 0; i < c.n_layer; ++i) {
    const std::string at = "block." + std::to_string(i) + ".";
    BlockWeights b;
    b.ln1_w = make(at + "ln1.weight", {width}, 0, 1);
    b.ln1_b = make(at + "ln1.bias", {width}, 0);
    b.qkv = make_linear(at + "qkv", 3 * width, width, kDeviation);
    b.proj = make_linear(at + "proj", width, width, residual);
    b.ln2_w = make(at + "ln2.weight", {width}, 0, 1);
    b.ln2_b = make(at + "ln2.bias", {width}, 0);
    b.up = make_linear(at + "up", 4 * width, width, kDeviation);
    b.down = make_linear(at + "down", width, 4 * width, residual);
    blocks_.push_back(b);
  }
  ln_w_ = make("ln.weight", {width}, 0, 1);
  ln_b_ = make("ln.bias", {width}, 0);
  head_ = make_linear("head", description.shape.vocabulary, width, kDeviation);
  if (c.output == "extrapolation")
    offset_head_ = make_linear("offset_head", sizes.offsets, width, kDeviation);
}

at::Tensor Transformer::drop(const at::Tensor& x) const {
  const double p = description_.config.dropout;
  return is_training() && p > 0 ? x * dropout_mask(x, p) : x;
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
  const std::int64_t free = extra.defined() ? extra.size(1) : 0;
  if (free > 0) x = at::cat({x, extra}, 1);
  const ModelConfig& c = description_.config;
  const BlockOptions options{c.n_head, free, is_training() ? c.dropout : 0, precision_};
  for (const BlockWeights& weights : blocks_) x = transformer_block(weights, x, options);
  return at::layer_norm(x, {x.size(2)}, ln_w_, ln_b_);
}

std::pair<at::Tensor, at::Tensor> Transformer::heads(const at::Tensor& flat) const {
  return {
      output_linear(head_, flat, precision_),
      offset_head_.weight.defined() ? output_linear(offset_head_, flat, precision_) : at::Tensor()};
}

at::Tensor Transformer::logits(const at::Tensor& hidden, const Batch& batch) {
  const auto [absolute, offsets] = heads(hidden.flatten(0, 1));
  const BinRange bins{description_.shape.first_bin, description_.shape.bins};
  return combined_logits(absolute, offsets, batch.centre.flatten(), bins)
      .view({hidden.size(0), hidden.size(1), -1});
}

at::Tensor Transformer::loss(const at::Tensor& hidden, const Batch& batch) {
  const auto [absolute, offsets] = heads(hidden.flatten(0, 1));
  const BinRange bins{description_.shape.first_bin, description_.shape.bins};
  return combined_cross_entropy(absolute, offsets, batch.centre.flatten(), batch.target.flatten(),
                                bins)
      .view({hidden.size(0), hidden.size(1)});
}

}  // namespace mocaplm
