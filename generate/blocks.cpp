#include "generate/blocks.h"

#include <cassert>

namespace mocaplm {

BlockStack::BlockStack(Weights& weights, const StackShape& shape, const EngineOptions& options,
                       Team& team, Arena& arena)
    : shape_(shape), team_(team) {
  take(weights, options, arena);
  make_room(options, arena);
}

void BlockStack::take(Weights& weights, const EngineOptions& options, Arena& arena) {
  const std::int64_t width = shape_.width;
  const auto linear = [&](const std::string& name, std::int64_t out, std::int64_t in) {
    return packed(weights, name, out, in, options.precision, arena);
  };
  for (std::int64_t i = 0; i < shape_.layers; ++i) {
    const std::string at = shape_.blocks + std::to_string(i) + ".";
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
  if (shape_.norm.empty()) return;
  ln_w_ = weights.take(shape_.norm + ".weight", {width});
  ln_b_ = weights.take(shape_.norm + ".bias", {width});
}

void BlockStack::make_room(const EngineOptions& options, Arena& arena) {
  const std::int64_t width = shape_.width;
  for (Block& b : blocks_)
    b.cache = KeyValueCache(options.sequences, shape_.heads, shape_.capacity, width / shape_.heads,
                            options.precision, arena);
  length_.assign(static_cast<std::size_t>(options.sequences), 0);
  rows_.reserve(static_cast<std::size_t>(kMaxRows));
  x_ = normed_ = attended_ = room(kMaxRows, width);
  qkv_ = room(kMaxRows, 3 * width);
  wide_ = room(kMaxRows, 4 * width);
  const Scratch one = {LinearScratch(4 * width),
                       room(kOwnRows, width),
                       room(1, blocks_.empty() ? 0 : blocks_.front().cache.scratch_size()),
                       {},
                       {}};
  scratch_.assign(static_cast<std::size_t>(team_.size()), one);
}

float* BlockStack::add(std::int64_t sequence) {
  if (ran_) rows_.clear();
  ran_ = false;
  std::int64_t& length = length_[static_cast<std::size_t>(sequence)];
  assert(!full() && length < capacity());
  rows_.push_back({sequence, length++});
  return x_.data() + (rows() - 1) * shape_.width;
}

// The normalised rows, for the calling thread or, computed by all of them, for all.
const float* BlockStack::normalise(const std::vector<float>& weight, const std::vector<float>& bias,
                                   int thread) {
  const std::int64_t width = shape_.width;
  const auto norm = kernels().layer_norm;
  if (rows() <= kOwnRows) {
    float* own = scratch_[static_cast<std::size_t>(thread)].normed.data();
    norm(x_.data(), weight.data(), bias.data(), rows(), width, own);
    return own;
  }
  const std::int64_t first = rows() * thread / team_.size(),
                     last = rows() * (thread + 1) / team_.size();
  norm(x_.data() + first * width, weight.data(), bias.data(), last - first, width,
       normed_.data() + first * width);
  team_.barrier();
  return normed_.data();
}

// True when every thread has the same number of heads, whose keys, queries and values fill whole
// panels: then it computes them itself and attends without waiting for the others.
bool BlockStack::own_heads() const {
  return shape_.heads % team_.size() == 0 && shape_.width / team_.size() % kPanel == 0;
}

// A thread's part of the queries (0), keys (1) or values (2).
Columns BlockStack::own_columns(std::int64_t section, int thread) const {
  const std::int64_t width = shape_.width, start = section * width;
  return {start + width * thread / team_.size(), start + width * (thread + 1) / team_.size()};
}

// visit(begin, end, h) for the heads h of the sequences, with rows [begin, end), that are the
// thread's.
template <class Visit>
void BlockStack::each_own_head(int thread, const Visit& visit) const {
  const std::int64_t share = shape_.heads / team_.size();
  const bool own = own_heads();
  std::int64_t pair = 0;
  for (std::size_t begin = 0, end; begin < rows_.size(); begin = end) {
    for (end = begin; end < rows_.size() && rows_[end].sequence == rows_[begin].sequence;) ++end;
    for (std::int64_t h = 0; h < shape_.heads; ++h, ++pair)
      if ((own ? h / share : pair % team_.size()) == thread) visit(begin, end, h);
  }
}

// A thread stores the keys and values of all rows of its heads, then attends, so that nobody waits
// between.
void BlockStack::self_attention(Block& block, int thread) {
  const std::int64_t width = shape_.width, head = width / shape_.heads;
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

void BlockStack::run_block(Block& block, int thread) {
  const int threads = team_.size();
  LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)].linear;
  const float* normed = normalise(block.ln1_w, block.ln1_b, thread);
  if (own_heads()) {
    block.qkv.apply_columns(
        normed, qkv_.data(), rows(), Store::plain, scratch,
        {own_columns(0, thread), own_columns(1, thread), own_columns(2, thread)});
  } else {
    block.qkv.apply(normed, qkv_.data(), rows(), Store::plain, scratch, thread, threads);
    team_.barrier();
  }
  self_attention(block, thread);
  team_.barrier();
  block.proj.apply(attended_.data(), x_.data(), rows(), Store::sum, scratch, thread, threads);
  team_.barrier();
  normed = normalise(block.ln2_w, block.ln2_b, thread);
  block.up.apply(normed, wide_.data(), rows(), Store::gelu, scratch, thread, threads);
  team_.barrier();
  block.down.apply(wide_.data(), x_.data(), rows(), Store::sum, scratch, thread, threads);
  team_.barrier();
}

// Lists what the thread will read in this step, the layer behind it included. Not for prompts,
// whose rows read the same again and again.
void BlockStack::look_ahead(int thread) {
  Scratch& scratch = scratch_[static_cast<std::size_t>(thread)];
  scratch.linear.ahead = nullptr;
  if (rows() < kFewestAhead) return;
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
  if (next_ != nullptr) next_->list(thread, threads, scratch.pieces);
  std::int64_t bytes = 0;
  for (const Piece& piece : scratch.pieces) bytes += piece.end - piece.begin;
  if (bytes < kCached) return;
  scratch.ahead =
      ahead_of(scratch.pieces.data(), scratch.pieces.data() + scratch.pieces.size(), kLead);
  scratch.linear.ahead = &scratch.ahead;
}

void BlockStack::run() {
  assert(!ran_);
  team_.run([this](int thread) {
    look_ahead(thread);
    for (Block& block : blocks_) run_block(block, thread);
  });
  ran_ = true;
}

void BlockStack::final_norm(const float* x, std::int64_t count, float* y) const {
  kernels().layer_norm(x, ln_w_.data(), ln_b_.data(), count, shape_.width, y);
}

std::int64_t BlockStack::bytes_a_step(std::int64_t sequences, std::int64_t count) const {
  std::int64_t bytes = 0;
  for (const Block& b : blocks_)
    bytes += b.qkv.bytes() + b.proj.bytes() + b.up.bytes() + b.down.bytes() +
             sequences * b.cache.bytes(count);
  return bytes;
}

}  // namespace mocaplm
