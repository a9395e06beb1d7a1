// "architecture": "flat" as a Decoder: a position a token.
#pragma once

#include "generate/decoder.h"
#include "generate/engine.h"

namespace mocaplm {

class FlatDecoder : public Decoder {
 public:
  FlatDecoder(const StoredModel& model, const std::string& place, const EngineOptions& options)
      : engine_(model, place, options),
        streams_(static_cast<std::size_t>(engine_.sequences())),
        pending_(streams_.size()) {}

  const ModelDescription& description() const override { return engine_.description(); }
  std::int64_t sequences() const override { return engine_.sequences(); }
  void begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
             const std::vector<std::int32_t>& before) override;
  void push(std::int64_t sequence, std::int32_t id) override;
  const std::vector<std::vector<float>>& logits(
      const std::vector<std::int64_t>& sequences) override;

 private:
  struct Stream {
    std::vector<std::int32_t> prefix, ids;
    std::size_t first = 0;  // index of the first token in the cache, a frame's start
  };

  void slide(std::int64_t sequence, Stream& stream);

  Engine engine_;
  std::vector<Stream> streams_;
  std::vector<ModelInput> pending_;  // of each stream, positions that the engine has not been fed
};

}  // namespace mocaplm
