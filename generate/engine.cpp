#include "generate/engine.h"

#include <algorithm>
#include <cassert>

#include "generate/weights.h"

namespace mocaplm {

namespace {

void add_row(float* to, const std::vector<float>& table, std::int32_t row, std::int64_t width) {
  const float* from = table.data() + static_cast<std::int64_t>(row) * width;
  for (std::int64_t i = 0; i < width; ++i) to[i] += from[i];
}

}  // namespace

void Engine::embed(const ModelInput& input, std::size_t i, std::int64_t position, float* x) const {
  const std::int64_t width = description_.config.n_embd;
  std::fill(x, x + width, 0.f);
  add_row(x, token_, input.token[i], width);
  if (!position_.empty()) {
    add_row(x, position_, static_cast<std::int32_t>(position), width);
  } else {
    add_row(x, frame_, input.frame[i], width);
    add_row(x, channel_, input.channel[i], width);
  }
  if (surprise_.empty()) return;
  add_row(x, surprise_, input.surprise[i], width);
  add_row(x, velocity_, input.velocity[i], width);
  add_row(x, last_surprise_, input.last_surprise[i], width);
}

// The normalised rows, for the calling thread or, computed by all of them, for all.
const float* Engine::normalise(const std::vector<float>& weight, const std::vector<float>& bias,
                               const float* x, std::int64_t rows, int thread) {
  const std::int64_t width = description_.config.n_embd;
  const auto norm = kernels().layer_norm;
  if (rows <= kOwnRows) {
    float* own = scratch_[static_cast<std::size_t>(thread)].normed.data();
    norm(x, weight.data(), bias.data(), rows, width, own);
    return own;
  }
  const std::int64_t first = rows * thread / team_.size(),
                     last = rows * (thread + 1) / team_.size();
  norm(x + first * width, weight.data(), bias.data(), last - first, width,
       normed_.data() + first * width);
  team_.barrier();
  return normed_.data();
}

// A thread has some of the (sequence, head) pairs: it stores their keys and values of all rows,
// then attends, so that nobody waits between.
void Engine::self_attention(Block& block, int thread) {
  const std::int64_t width = description_.config.n_embd, heads = description_.config.n_head,
                     head = width / heads;
  float* scratch = scratch_[static_cast<std::size_t>(thread)].attention.data();
  std::int64_t pair = 0;
  for (std::size_t begin = 0, end; begin < rows_.size(); begin = end) {
    for (end = begin; end < rows_.size() && rows_[end].sequence == rows_[begin].sequence;) ++end;
    for (std::int64_t h = 0; h < heads; ++h, ++pair) {
      if (pair % team_.size() != thread) continue;
      for (std::size_t r = begin; r < end; ++r) {
        const float* qkv = qkv_.data() + static_cast<std::int64_t>(r) * 3 * width + h * head;
        block.cache.store(rows_[r].sequence, h, rows_[r].position, qkv + width, qkv + 2 * width);
      }
      for (std::size_t r = begin; r < end; ++r)
        block.cache.attend(rows_[r].sequence, h, rows_[r].position + 1,
                           qkv_.data() + static_cast<std::int64_t>(r) * 3 * width + h * head,
                           scratch,
                           attended_.data() + static_cast<std::int64_t>(r) * width + h * head);
    }
  }
}

void Engine::run_block(Block& block, int thread) {
  const int threads = team_.size();
  const auto rows = static_cast<std::int64_t>(rows_.size());
  LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)].linear;
  const float* normed = normalise(block.ln1_w, block.ln1_b, x_.data(), rows, thread);
  block.qkv.apply(normed, qkv_.data(), rows, Store::plain, scratch, thread, threads);
  team_.barrier();
  self_attention(block, thread);
  team_.barrier();
  block.proj.apply(attended_.data(), x_.data(), rows, Store::sum, scratch, thread, threads);
  team_.barrier();
  normed = normalise(block.ln2_w, block.ln2_b, x_.data(), rows, thread);
  block.up.apply(normed, wide_.data(), rows, Store::gelu, scratch, thread, threads);
  team_.barrier();
  block.down.apply(wide_.data(), x_.data(), rows, Store::sum, scratch, thread, threads);
  team_.barrier();
}

void Engine::run_rows() {
  team_.run([this](int thread) {
    for (Block& block : blocks_) run_block(block, thread);
  });
  const std::int64_t width = description_.config.n_embd;
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (rows_[r].last)
      std::copy_n(x_.begin() + static_cast<std::ptrdiff_t>(r) * width, width,
                  last_.begin() + static_cast<std::ptrdiff_t>(rows_[r].feed) * width);
  rows_.clear();
}

void Engine::append(const std::vector<Feed>& feeds, bool keep_last) {
  assert(static_cast<std::int64_t>(feeds.size()) <= sequences());
  for (std::size_t f = 0; f < feeds.size(); ++f) {
    const ModelInput& input = *feeds[f].input;
    std::int64_t& length = length_[static_cast<std::size_t>(feeds[f].sequence)];
    assert(length + static_cast<std::int64_t>(input.size()) <= capacity());
    for (std::size_t i = 0; i < input.size(); ++i) {
      embed(input, i, length,
            x_.data() + static_cast<std::int64_t>(rows_.size()) * description_.config.n_embd);
      rows_.push_back({feeds[f].sequence, length++, f, keep_last && i + 1 == input.size()});
      if (static_cast<std::int64_t>(rows_.size()) == kMaxRows) run_rows();
    }
  }
  if (!rows_.empty()) run_rows();
}

void Engine::compute_logits(const std::vector<Feed>& feeds) {
  const ModelConfig& c = description_.config;
  const auto rows = static_cast<std::int64_t>(feeds.size());
  const bool shifted = c.output == "extrapolation";
  team_.run([&](int thread) {
    LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)].linear;
    const float* normed = normalise(ln_w_, ln_b_, last_.data(), rows, thread);
    head_.apply(normed, head_out_.data(), rows, Store::plain, scratch, thread, team_.size());
    if (shifted)
      offset_head_.apply(normed, offsets_.data(), rows, Store::plain, scratch, thread,
                         team_.size());
  });
  const std::int64_t vocabulary = head_.out();
  logits_.resize(feeds.size());
  for (std::size_t f = 0; f < feeds.size(); ++f) {
    const float* row = head_out_.data() + static_cast<std::int64_t>(f) * vocabulary;
    logits_[f].assign(row, row + vocabulary);
    const std::int64_t centre = feeds[f].input->centre.back();
    if (!shifted || centre == kNoCentre) continue;
    const float* offset = offsets_.data() + static_cast<std::int64_t>(f) * offset_head_.out();
    for (std::int64_t b = 0; b < description_.shape.bins; ++b)
      logits_[f][static_cast<std::size_t>(description_.shape.first_bin + b)] +=
          offset[std::clamp<std::int64_t>(b - centre, -c.reach, c.reach) + c.reach];
  }
}

void Engine::feed_silently(const std::vector<Feed>& feeds) {
  append(feeds, false);
}

const std::vector<std::vector<float>>& Engine::feed(const std::vector<Feed>& feeds) {
  for (const Feed& one : feeds) assert(one.input->size() > 0), (void)one;
  append(feeds, true);
  compute_logits(feeds);
  return logits_;
}

std::int64_t Engine::bytes_a_step(std::int64_t count) const {
  std::int64_t bytes = head_.bytes() + offset_head_.bytes();
  for (const Block& b : blocks_)
    bytes += b.qkv.bytes() + b.proj.bytes() + b.up.bytes() + b.down.bytes() +
             sequences() * b.cache.bytes(count);
  return bytes;
}

}  // namespace mocaplm
