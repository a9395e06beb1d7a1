// Decoding the flat transformer without LibTorch: its forward pass for several sequences at once,
// with packed weights and a key/value cache.
#pragma once

#include <string>
#include <vector>

#include "generate/blocks.h"
#include "generate/output_layer.h"
#include "model/directory.h"

namespace mocaplm {

class Engine {
 public:
  static constexpr std::int64_t kMaxSequences = mocaplm::kMaxSequences;

  // Packs the weights and reruns the stored self-test. Throws DataError when a tensor is missing or
  // of another shape, or the test fails. `place` is the model's directory, for messages.
  Engine(const StoredModel& model, const std::string& place, const EngineOptions& options = {});

  // Forgets the cached positions of a sequence.
  void reset(std::int64_t sequence = 0) { blocks_.reset(sequence); }
  std::int64_t length(std::int64_t sequence = 0) const { return blocks_.length(sequence); }
  std::int64_t capacity() const { return description_.config.block_size; }
  std::int64_t sequences() const { return options_.sequences; }

  // Positions that are appended to one sequence's cache, which must have room for them.
  struct Feed {
    std::int64_t sequence;
    const ModelInput* input;
  };
  // Appends (prompts by matrix products, a block of rows at a time) and returns the logits
  // (vocabulary) of each feed's last position, in their order, until the next call. A sequence may
  // come once.
  const std::vector<std::vector<float>>& feed(const std::vector<Feed>& feeds);
  // Feeds these sequences what waits for each of them, an entry for every sequence, and empties it.
  const std::vector<std::vector<float>>& feed(const std::vector<std::int64_t>& sequences,
                                              std::vector<ModelInput>& waiting);
  // The same without the output layer, for positions whose next token is known.
  void feed_silently(const std::vector<Feed>& feeds);
  // One sequence.
  const std::vector<float>& feed(const ModelInput& input) { return feed({{0, &input}})[0]; }
  void feed_silently(const ModelInput& input) { feed_silently({{0, &input}}); }

  const ModelDescription& description() const { return description_; }
  // Bytes that one step with `count` cached positions a sequence reads at the least.
  std::int64_t bytes_a_step(std::int64_t count) const {
    return blocks_.bytes_a_step(sequences(), count) + output_.bytes();
  }

 private:
  struct Embeddings {
    Embeddings(Weights& weights, const ModelDescription& description);
    void put(const ModelInput& input, std::size_t index, std::int64_t position, float* x) const;

    std::int64_t width;
    std::vector<float> token, frame, channel, position_table, surprise, velocity, last_surprise;
  };
  struct Last {  // a feed's last position among the rows that are computed together
    std::size_t feed;
    std::int64_t row;
  };

  Engine(const StoredModel& model, const std::string& place, const EngineOptions& options,
         const TensorMap& tensors);
  Engine(const StoredModel& model, const std::string& place, const EngineOptions& options,
         Weights&& weights);
  void append(const std::vector<Feed>& feeds);
  void run();
  void check(const StoredModel& model, const std::string& place);

  ModelDescription description_;
  EngineOptions options_;
  Team team_;
  Arena arena_;
  Embeddings embeddings_;
  BlockStack blocks_;
  OutputLayer output_;
  // Reused.
  std::vector<Last> lasts_;
  std::vector<float> last_, normed_;  // (feeds, width)
};

}  // namespace mocaplm
