#include "generate/engine.h"

#include <omp.h>

#include <algorithm>
#include <cassert>

#include "common/error.h"

namespace mocaplm {

namespace {

constexpr std::int64_t kRows = 64;  // positions of a prompt computed together

// Takes tensors out of the stored map, checking shapes; finish() finds what nobody asked for.
class Weights {
 public:
  Weights(const TensorMap& tensors, std::string place)
      : tensors_(tensors), place_(std::move(place)) {}

  const std::vector<float>& take(const std::string& name, const std::vector<std::int64_t>& shape) {
    const auto found = tensors_.find(name);
    if (found == tensors_.end())
      throw DataError(in_file(place_), "tensor \"" + name + "\" is missing");
    if (found->second.shape != shape)
      throw DataError(in_file(place_),
                      "tensor \"" + name + "\" has another shape than the config asks for");
    ++taken_;
    return found->second.values;
  }

  PackedLinear linear(const std::string& name, std::int64_t out, std::int64_t in) {
    const std::vector<float>& weight = take(name + ".weight", {out, in});
    return {weight.data(), take(name + ".bias", {out}).data(), out, in};
  }

  void finish() const {
    if (taken_ != tensors_.size())
      throw DataError(in_file(place_), "holds tensors that are not part of this model");
  }

 private:
  const TensorMap& tensors_;
  std::string place_;
  std::size_t taken_ = 0;
};

void add_row(float* to, const std::vector<float>& table, std::int32_t row, std::int64_t width) {
  const float* from = table.data() + static_cast<std::int64_t>(row) * width;
  for (std::int64_t i = 0; i < width; ++i) to[i] += from[i];
}

std::vector<float> room(std::int64_t rows, std::int64_t width) {
  return std::vector<float>(static_cast<std::size_t>(rows * width));
}

}  // namespace

Engine::Engine(const StoredModel& model, const std::string& place)
    : description_(model.description) {
  const ModelConfig& c = description_.config;
  const ModelSizes sizes = model_sizes(description_);
  const std::int64_t width = c.n_embd, vocabulary = description_.shape.vocabulary;
  const TensorMap tensors = language_tensors(model.tensors);
  Weights weights(tensors, place + "/model.safetensors");
  token_ = weights.take("token_embedding", {vocabulary, width});
  if (c.position == "custom") {
    frame_ = weights.take("frame_embedding", {sizes.frame_positions, width});
    channel_ = weights.take("channel_embedding", {sizes.channel_positions, width});
  } else {
    position_ = weights.take("position_embedding", {c.block_size, width});
  }
  if (c.history) {
    surprise_ = weights.take("history.surprise", {sizes.history_rows, width});
    velocity_ = weights.take("history.velocity", {sizes.history_rows, width});
    last_surprise_ = weights.take("history.last_surprise", {sizes.history_rows, width});
  }
  for (std::int64_t i = 0; i < c.n_layer; ++i) {
    const std::string at = "block." + std::to_string(i) + ".";
    Block b;
    b.ln1_w = weights.take(at + "ln1.weight", {width});
    b.ln1_b = weights.take(at + "ln1.bias", {width});
    b.qkv = weights.linear(at + "qkv", 3 * width, width);
    b.proj = weights.linear(at + "proj", width, width);
    b.ln2_w = weights.take(at + "ln2.weight", {width});
    b.ln2_b = weights.take(at + "ln2.bias", {width});
    b.up = weights.linear(at + "up", 4 * width, width);
    b.down = weights.linear(at + "down", width, 4 * width);
    b.keys = room(c.block_size, width);
    b.values = room(c.block_size, width);
    blocks_.push_back(std::move(b));
  }
  ln_w_ = weights.take("ln.weight", {width});
  ln_b_ = weights.take("ln.bias", {width});
  head_ = weights.linear("head", vocabulary, width);
  if (c.output == "extrapolation")
    offset_head_ = weights.linear("offset_head", sizes.offsets, width);
  weights.finish();
  x_ = normed_ = attended_ = room(kRows, width);
  qkv_ = room(kRows, 3 * width);
  wide_ = room(kRows, 4 * width);
  offsets_ = room(1, sizes.offsets);
  logits_ = room(1, vocabulary);
  for (const SelfTestCase& one : model.self_test) {
    check_input(one.input, description_, place + "/selftest.json");
    check_self_test(one, feed(one.input), place + "/selftest.json");
    reset();
  }
}

void Engine::embed(const ModelInput& input, std::int64_t first, std::int64_t rows) {
  const std::int64_t width = description_.config.n_embd;
  std::fill(x_.begin(), x_.begin() + rows * width, 0.f);
  for (std::int64_t r = 0; r < rows; ++r) {
    const auto i = static_cast<std::size_t>(first + r);
    float* x = x_.data() + r * width;
    add_row(x, token_, input.token[i], width);
    if (!position_.empty()) {
      add_row(x, position_, static_cast<std::int32_t>(length_ + r), width);
    } else {
      add_row(x, frame_, input.frame[i], width);
      add_row(x, channel_, input.channel[i], width);
    }
    if (surprise_.empty()) continue;
    add_row(x, surprise_, input.surprise[i], width);
    add_row(x, velocity_, input.velocity[i], width);
    add_row(x, last_surprise_, input.last_surprise[i], width);
  }
}

void Engine::self_attention(const Block& block, std::int64_t rows) {
  const std::int64_t width = description_.config.n_embd, heads = description_.config.n_head,
                     head = width / heads;
  // Here, not in the constructor: the number of threads may have been raised since.
  const auto scores = static_cast<std::size_t>(omp_get_max_threads() * capacity());
  if (scores_.size() < scores) scores_.resize(scores);
#pragma omp parallel for collapse(2) schedule(static) if (rows * length_ * width > 20000)
  for (std::int64_t r = 0; r < rows; ++r)
    for (std::int64_t h = 0; h < heads; ++h)
      attend(qkv_.data() + r * 3 * width + h * head, block.keys.data() + h * head,
             block.values.data() + h * head, length_ + r + 1, width, head,
             scores_.data() + omp_get_thread_num() * description_.config.block_size,
             attended_.data() + r * width + h * head);
}

void Engine::run_block(Block& block, std::int64_t rows) {
  const std::int64_t width = description_.config.n_embd;
  layer_norm(x_.data(), block.ln1_w.data(), block.ln1_b.data(), rows, width, normed_.data());
  block.qkv.apply(normed_.data(), qkv_.data(), rows);
  for (std::int64_t r = 0; r < rows; ++r) {
    const float* row = qkv_.data() + r * 3 * width;
    std::copy(row + width, row + 2 * width, block.keys.begin() + (length_ + r) * width);
    std::copy(row + 2 * width, row + 3 * width, block.values.begin() + (length_ + r) * width);
  }
  self_attention(block, rows);
  block.proj.apply(attended_.data(), normed_.data(), rows);
  for (std::int64_t i = 0; i < rows * width; ++i)
    x_[static_cast<std::size_t>(i)] += normed_[static_cast<std::size_t>(i)];
  layer_norm(x_.data(), block.ln2_w.data(), block.ln2_b.data(), rows, width, normed_.data());
  block.up.apply(normed_.data(), wide_.data(), rows);
  gelu(wide_.data(), rows * 4 * width);
  block.down.apply(wide_.data(), normed_.data(), rows);
  for (std::int64_t i = 0; i < rows * width; ++i)
    x_[static_cast<std::size_t>(i)] += normed_[static_cast<std::size_t>(i)];
}

void Engine::compute_logits(std::int64_t row, std::int32_t centre) {
  const ModelConfig& c = description_.config;
  layer_norm(x_.data() + row * c.n_embd, ln_w_.data(), ln_b_.data(), 1, c.n_embd, normed_.data());
  head_.apply(normed_.data(), logits_.data(), 1);
  if (c.output != "extrapolation" || centre == kNoCentre) return;
  offset_head_.apply(normed_.data(), offsets_.data(), 1);
  for (std::int64_t b = 0; b < description_.shape.bins; ++b)
    logits_[static_cast<std::size_t>(description_.shape.first_bin + b)] +=
        offsets_[static_cast<std::size_t>(std::clamp<std::int64_t>(b - centre, -c.reach, c.reach) +
                                          c.reach)];
}

void Engine::feed_silently(const ModelInput& input) {
  const auto count = static_cast<std::int64_t>(input.size());
  assert(length_ + count <= capacity());
  for (std::int64_t first = 0; first < count; first += kRows) {
    const std::int64_t rows = std::min(kRows, count - first);
    embed(input, first, rows);
    for (Block& block : blocks_) run_block(block, rows);
    length_ += rows;
  }
}

const std::vector<float>& Engine::feed(const ModelInput& input) {
  assert(input.size() > 0);
  feed_silently(input);
  compute_logits((static_cast<std::int64_t>(input.size()) - 1) % kRows, input.centre.back());
  return logits_;
}

}  // namespace mocaplm
