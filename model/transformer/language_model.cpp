#include "model/transformer/language_model.h"

#include <algorithm>
#include <cmath>

#include "model/transformer/dropout.h"
#include "model/transformer/frame_transformer.h"
#include "model/transformer/transformer.h"

namespace mocaplm {

namespace {

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
  moved.prefix = prefix;
  for (auto member : {&Batch::token, &Batch::frame, &Batch::channel, &Batch::centre,
                      &Batch::surprise, &Batch::velocity, &Batch::last_surprise, &Batch::target})
    if ((this->*member).defined()) moved.*member = (this->*member).to(device);
  return moved;
}

Batch stack(const std::vector<ModelInput>& inputs,
            const std::vector<std::vector<std::int32_t>>& targets) {
  Batch batch;
  const auto& frame = inputs.front().frame;
  batch.prefix =
      std::find_if(frame.begin(), frame.end(), [](auto f) { return f != 0; }) - frame.begin();
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

at::Tensor LanguageModel::make(const std::string& name, at::IntArrayRef shape, double deviation,
                               double mean) {
  at::Tensor value = at::full(shape, mean, at::kFloat);
  if (deviation > 0) value.normal_(mean, deviation);
  return register_parameter(parameter_name(name), value);
}

LinearWeights LanguageModel::make_linear(const std::string& name, std::int64_t out, std::int64_t in,
                                         double deviation) {
  LinearWeights linear;
  linear.weight = make(name + ".weight", {out, in}, deviation);
  linear.bias = make(name + ".bias", {out}, 0);
  return linear;
}

std::vector<BlockWeights> LanguageModel::make_blocks(const std::string& prefix, std::int64_t layers,
                                                     std::int64_t width) {
  const double residual = kDeviation / std::sqrt(2.0 * static_cast<double>(layers));
  std::vector<BlockWeights> blocks;
  for (std::int64_t i = 0; i < layers; ++i) {
    const std::string at = prefix + std::to_string(i) + ".";
    BlockWeights b;
    b.ln1_w = make(at + "ln1.weight", {width}, 0, 1);
    b.ln1_b = make(at + "ln1.bias", {width}, 0);
    b.qkv = make_linear(at + "qkv", 3 * width, width);
    b.proj = make_linear(at + "proj", width, width, residual);
    b.ln2_w = make(at + "ln2.weight", {width}, 0, 1);
    b.ln2_b = make(at + "ln2.bias", {width}, 0);
    b.up = make_linear(at + "up", 4 * width, width);
    b.down = make_linear(at + "down", width, 4 * width, residual);
    blocks.push_back(b);
  }
  return blocks;
}

FeedForwardWeights LanguageModel::make_feed_forward(const std::string& prefix, std::int64_t width,
                                                    std::int64_t wide) {
  FeedForwardWeights w;
  w.ln_w = make(prefix + "ln1.weight", {width}, 0, 1);
  w.ln_b = make(prefix + "ln1.bias", {width}, 0);
  w.up = make_linear(prefix + "up", wide, width);
  w.down = make_linear(prefix + "down", width, wide, kDeviation / std::sqrt(2.0));
  return w;
}

LanguageModel::LanguageModel(const ModelDescription& description) : description_(description) {
  check_model(description);
}

at::Tensor LanguageModel::drop(const at::Tensor& x) const {
  const double p = description_.config.dropout;
  return is_training() && p > 0 ? x * dropout_mask(x, p) : x;
}

at::Tensor LanguageModel::run_blocks(const std::vector<BlockWeights>& blocks, at::Tensor x,
                                     std::int64_t heads, std::int64_t free) const {
  const BlockOptions options{heads, free, is_training() ? description_.config.dropout : 0,
                             precision_};
  for (const BlockWeights& weights : blocks) x = transformer_block(weights, x, options);
  return x;
}

void LanguageModel::make_output(std::int64_t width) {
  head_ = make_linear("head", description_.shape.vocabulary, width);
  if (description_.config.output == "extrapolation")
    offset_head_ = make_linear("offset_head", model_sizes(description_).offsets, width);
}

std::pair<at::Tensor, at::Tensor> LanguageModel::heads(const at::Tensor& x) const {
  return {output_linear(head_, x, precision_), offset_head_.weight.defined()
                                                   ? output_linear(offset_head_, x, precision_)
                                                   : at::Tensor()};
}

at::Tensor LanguageModel::output_logits(const at::Tensor& x, const at::Tensor& centre) const {
  const auto [absolute, offsets] = heads(x);
  return combined_logits(absolute, offsets, centre, bins());
}

at::Tensor LanguageModel::output_loss(const at::Tensor& x, const at::Tensor& centre,
                                      const at::Tensor& target) const {
  const auto [absolute, offsets] = heads(x);
  return combined_cross_entropy(absolute, offsets, centre, target, bins());
}

std::shared_ptr<LanguageModel> make_language_model(const ModelDescription& description) {
  if (description.frame_positions()) return std::make_shared<FrameTransformer>(description);
  return std::make_shared<Transformer>(description);
}

}  // namespace mocaplm
