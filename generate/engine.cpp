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

// True when every thread has the same number of heads, whose keys, queries and values fill whole
// panels: then it computes them itself and attends without waiting for the others.
bool Engine::own_heads() const {
  const ModelConfig& c = description_.config;
  return c.n_head % team_.size() == 0 && c.n_embd / team_.size() % kPanel == 0;
}

// A thread's part of the queries (0), keys (1) or values (2).
Columns Engine::own_columns(std::int64_t section, int thread) const {
  const std::int64_t width = description_.config.n_embd, start = section * width;
  return {start + width * thread / team_.size(), start + width * (thread + 1) / team_.size()};
}

// visit(begin, end, h) for the heads h of the sequences, with rows [begin, end), that are the
// thread's.
template <class Visit>
void Engine::each_own_head(int thread, const Visit& visit) const {
  const std::int64_t heads = description_.config.n_head, share = heads / team_.size();
  const bool own = own_heads();
  std::int64_t pair = 0;
  for (std::size_t begin = 0, end; begin < rows_.size(); begin = end) {
    for (end = begin; end < rows_.size() && rows_[end].sequence == rows_[begin].sequence;) ++end;
    for (std::int64_t h = 0; h < heads; ++h, ++pair)
      if ((own ? h / share : pair % team_.size()) == thread) visit(begin, end, h);
  }
}

// A thread stores the keys and values of all rows of its heads, then attends, so that nobody waits
// between.
void Engine::self_attention(Block& block, int thread) {
  const std::int64_t width = description_.config.n_embd, head = width / description_.config.n_head;
  Scratch& scratch = scratch_[static_cast<std::size_t>(thread)];
  each_own_head(thread, [&](std::size_t begin, std::size_t end, std::int64_t h) {
    const auto at = [&](std::size_t r) {
      return qkv_.data() + static_cast<std::int64_t>(r) * 3 * width + h * head;
    };
    for (std::size_t r = begin; r < end; ++r)
      block.cache.store(rows_[r].sequence, h, rows_[r].position, at(r) + width, at(r) + 2 * width);
    for (std::size_t r = begin; r < end; ++r)
      block.cache.attend(
          rows_[r].sequence, h, rows_[r].position + 1, at(r), scratch.attention.data(),
          attended_.data() + static_cast<std::int64_t>(r) * width + h * head, scratch.linear.ahead);
  });
}

void Engine::run_block(Block& block, int thread) {
  const int threads = team_.size();
  const auto rows = static_cast<std::int64_t>(rows_.size());
  LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)].linear;
  const float* normed = normalise(block.ln1_w, block.ln1_b, x_.data(), rows, thread);
  if (own_heads()) {
    block.qkv.apply_columns(
        normed, qkv_.data(), rows, Store::plain, scratch,
        {own_columns(0, thread), own_columns(1, thread), own_columns(2, thread)});
  } else {
    block.qkv.apply(normed, qkv_.data(), rows, Store::plain, scratch, thread, threads);
    team_.barrier();
  }
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

// Lists what the thread will read in this step, the output layer included. Not for prompts, whose
// rows read the same again and again.
void Engine::look_ahead(int thread) {
  Scratch& scratch = scratch_[static_cast<std::size_t>(thread)];
  scratch.linear.ahead = nullptr;
  bool prompt = false;
  each_own_head(thread, [&](std::size_t begin, std::size_t end, std::int64_t) {
    prompt = prompt || end - begin > 1;
  });
  if (prompt) return;
  scratch.pieces.clear();
  const int threads = team_.size();
  for (const Block& block : blocks_) {
    if (own_heads())
      block.qkv.list({own_columns(0, thread), own_columns(1, thread), own_columns(2, thread)},
                     scratch.pieces);
    else
      block.qkv.list(thread, threads, scratch.pieces);
    each_own_head(thread, [&](std::size_t row, std::size_t, std::int64_t h) {
      block.cache.list(rows_[row].sequence, h, rows_[row].position + 1, scratch.pieces);
    });
    for (const PackedLinear* linear : {&block.proj, &block.up, &block.down})
      linear->list(thread, threads, scratch.pieces);
  }
  head_.list(thread, threads, scratch.pieces);
  std::int64_t bytes = 0;
  for (const Piece& piece : scratch.pieces) bytes += piece.end - piece.begin;
  if (bytes < kCached) return;
  scratch.ahead =
      ahead_of(scratch.pieces.data(), scratch.pieces.data() + scratch.pieces.size(), kLead);
  scratch.linear.ahead = &scratch.ahead;
}

void Engine::run_rows() {
  team_.run([this](int thread) {
    look_ahead(thread);
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
