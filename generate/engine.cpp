#include "generate/engine.h"

#include <algorithm>
#include <cassert>

#include "generate/tables.h"

namespace mocaplm {

Engine::Embeddings::Embeddings(Weights& weights, const ModelDescription& description)
    : width(description.config.n_embd) {
  const ModelConfig& c = description.config;
  const ModelSizes sizes = model_sizes(description);
  token = weights.take("token_embedding", {description.shape.vocabulary, width});
  if (c.position == "custom") {
    frame = weights.take("frame_embedding", {sizes.frame_positions, width});
    channel = weights.take("channel_embedding", {sizes.channel_positions, width});
  } else {
    position_table = weights.take("position_embedding", {c.block_size, width});
  }
  if (!c.history) return;
  surprise = weights.take("history.surprise", {sizes.history_rows, width});
  velocity = weights.take("history.velocity", {sizes.history_rows, width});
  last_surprise = weights.take("history.last_surprise", {sizes.history_rows, width});
}

void Engine::Embeddings::put(const ModelInput& input, std::size_t i, std::int64_t position,
                             float* x) const {
  std::fill(x, x + width, 0.f);
  add_row(x, token, input.token[i], width);
  if (!position_table.empty()) {
    add_row(x, position_table, static_cast<std::int32_t>(position), width);
  } else {
    add_row(x, frame, input.frame[i], width);
    add_row(x, channel, input.channel[i], width);
  }
  if (surprise.empty()) return;
  add_row(x, surprise, input.surprise[i], width);
  add_row(x, velocity, input.velocity[i], width);
  add_row(x, last_surprise, input.last_surprise[i], width);
}

Engine::Engine(const StoredModel& model, const std::string& place, const EngineOptions& options)
    : Engine(model, place, options, language_tensors(model.tensors)) {}

Engine::Engine(const StoredModel& model, const std::string& place, const EngineOptions& options,
               const TensorMap& tensors)
    : Engine(model, place, options, Weights(tensors, place + "/model.safetensors")) {}

Engine::Engine(const StoredModel& model, const std::string& place, const EngineOptions& options,
               Weights&& weights)
    : description_(model.description),
      options_(checked(options)),
      team_(options.threads),
      embeddings_(weights, description_),
      blocks_(weights,
              {"block.", "ln", description_.config.n_layer, description_.config.n_head,
               description_.config.n_embd, description_.config.block_size},
              options_, team_, arena_),
      output_(weights, description_, description_.config.n_embd, options_, team_, arena_),
      last_(static_cast<std::size_t>(options_.sequences * description_.config.n_embd)),
      normed_(last_.size()) {
  weights.finish();
  blocks_.followed_by(&output_.head());
  check(model, place);
}

void Engine::check(const StoredModel& model, const std::string& place) {
  const std::string file = place + "/selftest.json";
  for (const SelfTestCase& one : model.self_test) {
    check_input(one.input, description_, file);
    check_self_test(one, feed(one.input), file, rounding_tolerance(options_.precision));
    reset();
  }
}

void Engine::run() {
  const std::int64_t width = blocks_.width();
  blocks_.run();
  for (const Last& last : lasts_)
    std::copy_n(blocks_.row(last.row), width,
                last_.begin() + static_cast<std::ptrdiff_t>(last.feed) * width);
  lasts_.clear();
}

void Engine::append(const std::vector<Feed>& feeds) {
  assert(static_cast<std::int64_t>(feeds.size()) <= sequences());
  std::int64_t rows = 0;
  for (std::size_t f = 0; f < feeds.size(); ++f) {
    const ModelInput& input = *feeds[f].input;
    for (std::size_t i = 0; i < input.size(); ++i) {
      const std::int64_t position = length(feeds[f].sequence);
      embeddings_.put(input, i, position, blocks_.add(feeds[f].sequence));
      if (i + 1 == input.size()) lasts_.push_back({f, rows});
      if (++rows == kMaxRows) run(), rows = 0;
    }
  }
  if (rows > 0) run();
}

void Engine::feed_silently(const std::vector<Feed>& feeds) {
  append(feeds);
}

const std::vector<std::vector<float>>& Engine::feed(const std::vector<Feed>& feeds) {
  std::vector<std::int32_t> centre;
  for (const Feed& one : feeds) {
    assert(one.input->size() > 0);
    centre.push_back(one.input->centre.back());
  }
  append(feeds);
  blocks_.final_norm(last_.data(), static_cast<std::int64_t>(feeds.size()), normed_.data());
  return output_.logits(normed_.data(), centre);
}

const std::vector<std::vector<float>>& Engine::feed(const std::vector<std::int64_t>& sequences,
                                                    std::vector<ModelInput>& waiting) {
  std::vector<Feed> feeds;
  for (const std::int64_t s : sequences)
    feeds.push_back({s, &waiting[static_cast<std::size_t>(s)]});
  const auto& logits = feed(feeds);
  for (const std::int64_t s : sequences) waiting[static_cast<std::size_t>(s)] = ModelInput();
  return logits;
}

}  // namespace mocaplm
