// What generation asks of a model, whatever its architecture: several streams side by side, to
// which tokens are appended as they are known or chosen.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "generate/options.h"
#include "model/directory.h"

namespace mocaplm {

class Decoder {
 public:
  virtual ~Decoder() = default;

  virtual const ModelDescription& description() const = 0;
  virtual std::int64_t sequences() const = 0;

  // Starts a stream anew with these prefix tokens. `before`: whole frames that precede it, which
  // the model does not see, though it knows from them how each channel moved.
  virtual void begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
                     const std::vector<std::int32_t>& before) = 0;
  // Whether the joints of a frame may come in any order; then set_order, at the start of a frame,
  // tells it: every channel once, the three of a joint one after the other.
  virtual bool any_order() const { return false; }
  virtual void set_order(std::int64_t sequence, const std::vector<int>& channels);

  // The next token of a stream: a bin of the next channel, or the separator behind the last; with
  // pieces (generate/piece_decoder.h) any token that fits there. Past the context the older half of
  // the frames is forgotten; the prefix stays.
  virtual void push(std::int64_t sequence, std::int32_t id) = 0;
  // Logits (vocabulary) for the next token of each of these sequences, a bin; until the next call.
  // Between two calls a sequence must get a token, or begin anew.
  virtual const std::vector<std::vector<float>>& logits(
      const std::vector<std::int64_t>& sequences) = 0;
};

// The decoder of the model's architecture. Packs the weights and reruns the stored self-test;
// throws DataError when a tensor is missing or of another shape, or the test fails. `place` is the
// model's directory, for messages.
std::unique_ptr<Decoder> make_decoder(const StoredModel& model, const std::string& place,
                                      const EngineOptions& options = {});

}  // namespace mocaplm
