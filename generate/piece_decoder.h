// "architecture": "flat" with pieces as a Decoder: a position a piece. `push` takes any token that
// fits (PieceVocabulary::fits), and what comes next may be any such token.
#pragma once

#include "generate/decoder.h"
#include "generate/engine.h"
#include "tokenizer/piece_vocabulary.h"

namespace mocaplm {

class PieceDecoder : public Decoder {
 public:
  PieceDecoder(const StoredModel& model, const std::string& place, const EngineOptions& options);

  const ModelDescription& description() const override { return engine_.description(); }
  std::int64_t sequences() const override { return engine_.sequences(); }
  // `before`: characters.
  void begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
             const std::vector<std::int32_t>& before) override;
  void push(std::int64_t sequence, std::int32_t id) override;
  const std::vector<std::vector<float>>& logits(
      const std::vector<std::int64_t>& sequences) override;

 private:
  struct Stream {
    std::vector<std::int32_t> prefix;
    std::vector<std::int32_t> ids;     // characters
    std::vector<std::int32_t> tokens;  // that tell those behind `before`
    std::vector<std::size_t> starts;   // of each token, its first character; then the end
    std::size_t first = 0;             // token at which the cache begins, a frame's first
  };

  void slide(std::int64_t sequence, Stream& stream);

  PieceVocabulary pieces_;
  Engine engine_;
  std::vector<Stream> streams_;
  std::vector<ModelInput> pending_;  // of each stream, positions that the engine has not been fed
};

// The pieces of a stored model, none where it speaks single characters. Throws DataError when they
// are not what its config says.
PieceVocabulary stored_pieces(const StoredModel& model, const std::string& place);

}  // namespace mocaplm
