#include "generate/blocks.h"

#include <cassert>

namespace mocaplm {

namespace {

std::vector<float> room(std::int64_t rows, std::int64_t width) {
  return std::vector<float>(static_cast<std::size_t>(rows * width));
}

}  // namespace

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
    const std::string at = shape_.prefix + "block." + std::to_string(i) + ".";
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
  ln_w_ = weights.take(shape_.prefix + "ln.weight", {width});
  ln_b_ = weights.take(shape_.prefix + "ln.bias", {width});
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
  const Scratch one = {LinearScratch(4 * width), room(kOwnRows, width),
                       room(1, blocks_.front().cache.scratch_size())};
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

// A thread has some of the (sequence, head) pairs: it stores their keys and values of all rows,
// then attends, so that nobody waits between.
void BlockStack::self_attention(Block& block, int thread) {
  const std::int64_t width = shape_.width, head = width / shape_.heads;
  float* scratch = scratch_[static_cast<std::size_t>(thread)].attention.data();
  std::int64_t pair = 0;
  for (std::size_t begin = 0, end; begin < rows_.size(); begin = end) {
    for (end = begin; end < rows_.size() && rows_[end].sequence == rows_[begin].sequence;) ++end;
    for (std::int64_t h = 0; h < shape_.heads; ++h, ++pair) {
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

void BlockStack::run_block(Block& block, int thread) {
  const int threads = team_.size();
  LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)].linear;
  const float* normed = normalise(block.ln1_w, block.ln1_b, thread);
  block.qkv.apply(normed, qkv_.data(), rows(), Store::plain, scratch, thread, threads);
  team_.barrier();
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

void BlockStack::run() {
  assert(!ran_);
  team_.run([this](int thread) {
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
