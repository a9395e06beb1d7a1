// Decoding without LibTorch: the flat transformer's forward pass for several sequences at once,
// with packed weights and a key/value cache.
#pragma once

#include <string>
#include <vector>

#include "generate/kernels/cache.h"
#include "generate/kernels/linear.h"
#include "generate/team.h"
#include "model/directory.h"

namespace mocaplm {

class Weights;

struct EngineOptions {
  Precision precision = Precision::f32;
  int threads = 0;             // 0: one a core
  std::int64_t sequences = 1;  // that are decoded side by side, 1 to kMaxSequences
};

class Engine {
 public:
  static constexpr std::int64_t kMaxSequences = kMaxRows;

  // Packs the weights and reruns the stored self-test. Throws DataError when a tensor is missing or
  // of another shape, or the test fails. `place` is the model's directory, for messages.
  Engine(const StoredModel& model, const std::string& place, const EngineOptions& options = {});

  // Forgets the cached positions of a sequence.
  void reset(std::int64_t sequence = 0) { length_[static_cast<std::size_t>(sequence)] = 0; }
  std::int64_t length(std::int64_t sequence = 0) const {
    return length_[static_cast<std::size_t>(sequence)];
  }
  std::int64_t capacity() const { return description_.config.block_size; }
  std::int64_t sequences() const { return static_cast<std::int64_t>(length_.size()); }

  // Positions that are appended to one sequence's cache, which must have room for them.
  struct Feed {
    std::int64_t sequence;
    const ModelInput* input;
  };
  // Appends (prompts by matrix products, a block of rows at a time) and returns the logits
  // (vocabulary) of each feed's last position, in their order, until the next call. A sequence may
  // come once.
  const std::vector<std::vector<float>>& feed(const std::vector<Feed>& feeds);
  // The same without the output layer, for positions whose next token is known.
  void feed_silently(const std::vector<Feed>& feeds);
  // One sequence.
  const std::vector<float>& feed(const ModelInput& input) { return feed({{0, &input}})[0]; }
  void feed_silently(const ModelInput& input) { feed_silently({{0, &input}}); }

  const ModelDescription& description() const { return description_; }
  // Bytes that one step with `count` cached positions a sequence reads at the least.
  std::int64_t bytes_a_step(std::int64_t count) const;

 private:
  // Bytes that a thread asks for before it needs them: enough to bridge what it computes between
  // two readings, and little beside its cache.
  static constexpr std::int64_t kLead = 192 << 10;
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
    std::size_t feed;
    bool last;  // of its feed
  };
  struct alignas(64) Scratch {  // a thread's own
    LinearScratch linear;
    std::vector<float> normed, attention;
    std::vector<Piece> pieces;  // that a step reads
    Ahead ahead;
  };

  void take_embeddings(Weights& weights);
  void take_blocks(Weights& weights);
  void make_room();
  void check(const StoredModel& model, const std::string& place);

  void append(const std::vector<Feed>& feeds, bool keep_last);
  void embed(const ModelInput& input, std::size_t index, std::int64_t position, float* x) const;
  void run_rows();
  void look_ahead(int thread);
  void run_block(Block& block, int thread);
  bool own_heads() const;
  Columns own_columns(std::int64_t section, int thread) const;
  template <class Visit>
  void each_own_head(int thread, const Visit& visit) const;
  void self_attention(Block& block, int thread);
  const float* normalise(const std::vector<float>& weight, const std::vector<float>& bias,
                         const float* x, std::int64_t rows, int thread);
  void compute_logits(const std::vector<Feed>& feeds);

  ModelDescription description_;
  EngineOptions options_;
  Team team_;
  Arena arena_;
  std::vector<float> token_, frame_, channel_, position_, surprise_, velocity_, last_surprise_;
  std::vector<Block> blocks_;
  std::vector<float> ln_w_, ln_b_;
  PackedLinear head_, offset_head_;
  std::vector<std::int64_t> length_;  // of each sequence's cache
  // Reused: the rows that are computed together, their residual stream, and what blocks need.
  std::vector<Row> rows_;
  std::vector<float> x_, normed_, qkv_, attended_, wide_, last_, head_out_, offsets_;
  std::vector<Scratch> scratch_;
  std::vector<std::vector<float>> logits_;
};

}  // namespace mocaplm
