// Making an engine out of a stored model.
#include <algorithm>

#include "generate/engine.h"
#include "generate/weights.h"

namespace mocaplm {

namespace {

std::vector<float> room(std::int64_t rows, std::int64_t width) {
  return std::vector<float>(static_cast<std::size_t>(rows * width));
}

// Mean distance of the logits over their spread that rounding may leave.
double tolerance(Precision precision) {
  return precision == Precision::int8 ? 0.15 : precision == Precision::bf16 ? 0.05 : 0;
}

}  // namespace

Engine::Engine(const StoredModel& model, const std::string& place, const EngineOptions& options)
    : description_(model.description), options_(options), team_(options.threads) {
  if (options.sequences < 1 || options.sequences > kMaxSequences)
    throw UsageError("an engine decodes 1 to " + std::to_string(kMaxSequences) +
                     " sequences at once");
  const TensorMap tensors = language_tensors(model.tensors);
  Weights weights(tensors, place + "/model.safetensors");
  take_embeddings(weights);
  take_blocks(weights);
  weights.finish();
  make_room();
  check(model, place);
}

void Engine::take_embeddings(Weights& weights) {
  const ModelConfig& c = description_.config;
  const ModelSizes sizes = model_sizes(description_);
  const std::int64_t width = c.n_embd;
  token_ = weights.take("token_embedding", {description_.shape.vocabulary, width});
  if (c.position == "custom") {
    frame_ = weights.take("frame_embedding", {sizes.frame_positions, width});
    channel_ = weights.take("channel_embedding", {sizes.channel_positions, width});
  } else {
    position_ = weights.take("position_embedding", {c.block_size, width});
  }
  if (!c.history) return;
  surprise_ = weights.take("history.surprise", {sizes.history_rows, width});
  velocity_ = weights.take("history.velocity", {sizes.history_rows, width});
  last_surprise_ = weights.take("history.last_surprise", {sizes.history_rows, width});
}

void Engine::take_blocks(Weights& weights) {
  const ModelConfig& c = description_.config;
  const std::int64_t width = c.n_embd;
  const auto linear = [&](const std::string& name, std::int64_t out, std::int64_t in) {
    const float* weight = weights.take(name + ".weight", {out, in}).data();
    return PackedLinear(weight, weights.take(name + ".bias", {out}).data(), out, in,
                        options_.precision, arena_);
  };
  for (std::int64_t i = 0; i < c.n_layer; ++i) {
    const std::string at = "block." + std::to_string(i) + ".";
    Block b;
    b.ln1_w = weights.take(at + "ln1.weight", {width});
    b.ln1_b = weights.take(at + "ln1.bias", {width});
    b.qkv = linear(at + "qkv", 3 * width, width);
    b.proj = linear(at + "proj", width, width);
    b.ln2_w = weights.take(at + "ln2.weight", {width});
    b.ln2_b = weights.take(at + "ln2.bias", {width});
    b.up = linear(at + "up", 4 * width, width);
    b.down = linear(at + "down", width, 4 * width);
    blocks_.push_back(std::move(b));
  }
  ln_w_ = weights.take("ln.weight", {width});
  ln_b_ = weights.take("ln.bias", {width});
  head_ = linear("head", description_.shape.vocabulary, width);
  if (c.output == "extrapolation")
    offset_head_ = linear("offset_head", model_sizes(description_).offsets, width);
}

void Engine::make_room() {
  const ModelConfig& c = description_.config;
  const std::int64_t width = c.n_embd;
  for (Block& b : blocks_)
    b.cache = KeyValueCache(options_.sequences, c.n_head, c.block_size, width / c.n_head,
                            options_.precision, arena_);
  length_.assign(static_cast<std::size_t>(options_.sequences), 0);
  rows_.reserve(static_cast<std::size_t>(kMaxRows));
  x_ = normed_ = attended_ = room(kMaxRows, width);
  last_ = room(options_.sequences, width);
  qkv_ = room(kMaxRows, 3 * width);
  wide_ = room(kMaxRows, 4 * width);
  head_out_ = room(options_.sequences, head_.out());
  offsets_ = room(options_.sequences, offset_head_.out());
  const Scratch one = {LinearScratch(4 * width),
                       room(kOwnRows, width),
                       room(1, blocks_.front().cache.scratch_size()),
                       {},
                       {}};
  scratch_.assign(static_cast<std::size_t>(team_.size()), one);
}

void Engine::check(const StoredModel& model, const std::string& place) {
  const std::string file = place + "/selftest.json";
  for (const SelfTestCase& one : model.self_test) {
    check_input(one.input, description_, file);
    check_self_test(one, feed(one.input), file, tolerance(options_.precision));
    reset();
  }
}

}  // namespace mocaplm
