// Decoding without LibTorch: the flat transformer's forward pass in f32 with a key/value cache.
#pragma once

#include <string>
#include <vector>

#include "generate/kernels.h"
#include "model/directory.h"

namespace mocaplm {

class Engine {
 public:
  // Packs the weights and reruns the stored self-test. Throws DataError when a tensor is missing or
  // of another shape, or the test fails. `place` is the model's directory, for messages.
  Engine(const StoredModel& model, const std::string& place);

  // Forgets the cached positions.
  void reset() { length_ = 0; }
  std::int64_t length() const { return length_; }  // positions in the cache
  std::int64_t capacity() const { return description_.config.block_size; }

  // Appends the input's positions to the cache (prompts by matrix products, a block of rows at a
  // time) and returns the logits (vocabulary) of the last one. The cache must have room.
  const std::vector<float>& feed(const ModelInput& input);
  // The same without the output layer, for positions whose next token is known.
  void feed_silently(const ModelInput& input);

  const ModelDescription& description() const { return description_; }

 private:
  struct Block {
    std::vector<float> ln1_w, ln1_b, ln2_w, ln2_b;
    PackedLinear qkv, proj, up, down;
    std::vector<float> keys, values;  // (capacity, C): the cache
  };

  void embed(const ModelInput& input, std::int64_t first, std::int64_t rows);
  void run_block(Block& block, std::int64_t rows);
  void self_attention(const Block& block, std::int64_t rows);
  void compute_logits(std::int64_t row, std::int32_t centre);

  ModelDescription description_;
  std::vector<float> token_, frame_, channel_, position_, surprise_, velocity_, last_surprise_;
  std::vector<Block> blocks_;
  std::vector<float> ln_w_, ln_b_;
  PackedLinear head_, offset_head_;
  std::int64_t length_ = 0;
  // Scratch, reused: the residual stream and what the blocks need, for up to kRows positions.
  std::vector<float> x_, normed_, qkv_, attended_, wide_, scores_, offsets_, logits_;
};

}  // namespace mocaplm
