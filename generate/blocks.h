// A stack of pre-norm transformer blocks (thesis Figure 4.1) that decodes: several sequences side
// by side, each with its keys and values of the positions so far.
#pragma once

#include <string>
#include <vector>

#include "generate/kernels/cache.h"
#include "generate/kernels/linear.h"
#include "generate/options.h"
#include "generate/team.h"
#include "generate/weights.h"

namespace mocaplm {

// Zeros, (rows, width).
inline std::vector<float> room(std::int64_t rows, std::int64_t width) {
  return std::vector<float>(static_cast<std::size_t>(rows * width));
}

struct StackShape {
  std::string blocks;  // the tensors' names begin so: "block." for block.0.ln1.weight and so on
  std::string norm;    // "ln" for ln.weight and ln.bias behind the last block; "": there is none
  std::int64_t layers, heads, width;
  std::int64_t capacity;  // positions a sequence
};

class BlockStack {
 public:
  // Packs the weights. Team and arena must outlive it.
  BlockStack(Weights& weights, const StackShape& shape, const EngineOptions& options, Team& team,
             Arena& arena);

  std::int64_t width() const { return shape_.width; }
  std::int64_t capacity() const { return shape_.capacity; }
  std::int64_t length(std::int64_t sequence) const {
    return length_[static_cast<std::size_t>(sequence)];
  }
  // Forgets the positions of a sequence.
  void reset(std::int64_t sequence) { length_[static_cast<std::size_t>(sequence)] = 0; }

  // The next position of a sequence, which must have room for it: (width) to be filled before
  // run(). The rows of one sequence come one after the other, and at most kMaxRows in all.
  float* add(std::int64_t sequence);
  std::int64_t rows() const { return static_cast<std::int64_t>(rows_.size()); }
  bool full() const { return rows() == kMaxRows; }
  // All rows through all blocks. Results stay until the next add().
  void run();
  const float* row(std::int64_t index) const { return x_.data() + index * shape_.width; }

  // The norm after the last block, of rows (count, width).
  void final_norm(const float* x, std::int64_t count, float* y) const;

  // A layer that is applied to the rows after each run, shared among the threads: fetched in time.
  void followed_by(const PackedLinear* linear) { next_ = linear; }

  // Bytes that one step with `count` cached positions in each of `sequences` reads at the least.
  std::int64_t bytes_a_step(std::int64_t sequences, std::int64_t count) const;

 private:
  // Bytes that a thread asks for before it needs them: enough to bridge what it computes between
  // two readings, and little beside its cache.
  static constexpr std::int64_t kLead = 192 << 10;
  // Rows from which on it pays: with fewer, asking costs more than the processor's own prefetching
  // leaves to gain.
  static constexpr std::int64_t kFewestAhead = 4;
  // Steps that read less than this much stay in the caches by themselves.
  static constexpr std::int64_t kCached = 2 << 20;
  // Up to so many rows every thread normalises for itself: cheaper than waiting for the others.
  static constexpr std::int64_t kOwnRows = 4;

  struct Block {
    std::vector<float> ln1_w, ln1_b, ln2_w, ln2_b;
    PackedLinear qkv, proj, up, down;
    KeyValueCache cache;
  };
  struct Row {
    std::int64_t sequence, position;
  };
  struct alignas(64) Scratch {  // a thread's own
    LinearScratch linear;
    std::vector<float> normed, attention;
    std::vector<Piece> pieces;  // that a step reads
    Ahead ahead;
  };

  void take(Weights& weights, const EngineOptions& options, Arena& arena);
  void make_room(const EngineOptions& options, Arena& arena);
  void look_ahead(int thread);
  void run_block(Block& block, int thread);
  bool own_heads() const;
  Columns own_columns(std::int64_t section, int thread) const;
  template <class Visit>
  void each_own_head(int thread, const Visit& visit) const;
  void self_attention(Block& block, int thread);
  const float* normalise(const std::vector<float>& weight, const std::vector<float>& bias,
                         int thread);

  StackShape shape_;
  Team& team_;
  std::vector<Block> blocks_;
  std::vector<float> ln_w_, ln_b_;
  const PackedLinear* next_ = nullptr;
  std::vector<std::int64_t> length_;  // of each sequence's cache
  // Reused: the rows that are computed together, their residual stream, and what blocks need.
  std::vector<Row> rows_;
  bool ran_ = false;  // the rows are those of the last run
  std::vector<float> x_, normed_, qkv_, attended_, wide_;
  std::vector<Scratch> scratch_;
};

}  // namespace mocaplm
