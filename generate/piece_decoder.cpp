#include "generate/piece_decoder.h"

#include <algorithm>
#include <cassert>

#include "common/error.h"

namespace mocaplm {

PieceVocabulary stored_pieces(const StoredModel& model, const std::string& place) {
  const ModelDescription& d = model.description;
  if (!d.has_pieces()) return {};
  const Tokenizer tokenizer = Tokenizer::of_model(model.tokenizer, d.tokenizer_fingerprint, place);
  PieceVocabulary pieces =
      PieceVocabulary::of_model(model.pieces, tokenizer, d.pieces_fingerprint, place);
  if (pieces.count() != d.shape.pieces || pieces.longest() != d.shape.longest ||
      tokenizer.channels() != d.shape.channels || tokenizer.bins() != d.shape.bins)
    throw DataError(in_file(place), "pieces.model holds " + std::to_string(pieces.count()) +
                                        " pieces of up to " + std::to_string(pieces.longest()) +
                                        " characters, config.json says " +
                                        std::to_string(d.shape.pieces) + " of up to " +
                                        std::to_string(d.shape.longest));
  return pieces;
}

PieceDecoder::PieceDecoder(const StoredModel& model, const std::string& place,
                           const EngineOptions& options)
    : pieces_(stored_pieces(model, place)),
      engine_(model, place, options),
      streams_(static_cast<std::size_t>(engine_.sequences())),
      pending_(streams_.size()) {}

void PieceDecoder::begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
                         const std::vector<std::int32_t>& before) {
  engine_.reset(sequence);
  const auto s = static_cast<std::size_t>(sequence);
  streams_[s] = {prefix, before, {}, {before.size()}};
  pending_[s] = window_input(description(), prefix, before, before.size(), 0);
}

void PieceDecoder::push(std::int64_t sequence, std::int32_t id) {
  const auto s = static_cast<std::size_t>(sequence);
  Stream& stream = streams_[s];
  const auto waiting = static_cast<std::int64_t>(pending_[s].size());
  if (engine_.length(sequence) + waiting >= engine_.capacity()) slide(sequence, stream);
  const PieceVocabulary::Characters characters = pieces_.characters(id);
  const std::size_t index = stream.ids.size(), begin = stream.starts[stream.first];
  assert(pieces_.fits(id, static_cast<int>(index % static_cast<std::size_t>(
                                                       description().shape.tokens_per_frame()))));
  stream.ids.insert(stream.ids.end(), characters.data, characters.data + characters.size);
  stream.tokens.push_back(id);
  stream.starts.push_back(stream.ids.size());
  append_piece(pending_[s], description(), stream.ids, begin, index, id, characters.size);
}

// Whole frames at a time; the context holds two frames of single characters (check_model), so that
// its younger half always holds the beginning of one.
void PieceDecoder::slide(std::int64_t sequence, Stream& stream) {
  const auto per_frame = static_cast<std::size_t>(description().shape.tokens_per_frame());
  const std::size_t room = static_cast<std::size_t>(engine_.capacity()) - stream.prefix.size();
  const std::size_t done = stream.tokens.size();
  std::size_t first = done - std::min(done, room / 2);
  while (first < done && stream.starts[first] % per_frame != 0) ++first;
  stream.first = first;
  engine_.reset(sequence);
  pending_[static_cast<std::size_t>(sequence)] =
      piece_window_input(description(), stream.prefix, {stream.ids, stream.tokens, stream.starts},
                         first, done - first);
}

const std::vector<std::vector<float>>& PieceDecoder::logits(
    const std::vector<std::int64_t>& sequences) {
  return engine_.feed(sequences, pending_);
}

}  // namespace mocaplm
