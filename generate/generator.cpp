#include "generate/generator.h"

#include <algorithm>

#include "common/error.h"
#include "generate/dance.h"
#include "generate/piece_decoder.h"

namespace mocaplm {

namespace {

Tokenizer matching_tokenizer(const StoredModel& model, const std::string& place) {
  Tokenizer tokenizer =
      Tokenizer::of_model(model.tokenizer, model.description.tokenizer_fingerprint, place);
  const StreamShape& shape = model.description.shape;
  if (tokenizer.vocabulary() + shape.pieces != shape.vocabulary ||
      tokenizer.channels() != shape.channels || tokenizer.bins() != shape.bins ||
      Tokenizer::kFirstBin != shape.first_bin)
    throw DataError(in_file(place),
                    "tokenizer.json is not the tokenizer that this model was trained with");
  return tokenizer;
}

}  // namespace

Generator::Generator(const StoredModel& model, const std::string& place,
                     const EngineOptions& options)
    : decoder_(make_decoder(model, place, options)),
      tokenizer_(matching_tokenizer(model, place)),
      pieces_(stored_pieces(model, place)) {}

GenerateResult Generator::generate(const GenerateRequest& request, const OnFrame& on_frame) {
  return generate(std::vector<GenerateRequest>{request}, on_frame)[0];
}

std::vector<GenerateResult> Generator::generate(const std::vector<GenerateRequest>& requests,
                                                const OnFrame& on_frame) {
  std::vector<DanceInMaking> dances;
  for (const GenerateRequest& request : requests)
    dances.emplace_back(dances.size(), request, *decoder_, tokenizer_, pieces_, on_frame);
  decode(dances);
  std::vector<GenerateResult> results;
  for (const DanceInMaking& dance : dances) results.push_back(dance.result());
  return results;
}

// A dance that ends gives its sequence to the next one that waits.
void Generator::decode(std::vector<DanceInMaking>& dances) {
  std::vector<DanceInMaking*> active;
  std::vector<std::int64_t> free;
  for (std::int64_t s = decoder_->sequences(); s-- > 0;) free.push_back(s);
  auto next = dances.begin();
  const auto ended = [&](DanceInMaking* dance) {
    dance->advance();
    if (dance->done()) free.push_back(dance->sequence());
    return dance->done();
  };
  for (;;) {
    active.erase(std::remove_if(active.begin(), active.end(), ended), active.end());
    for (; !free.empty() && next != dances.end(); ++next) {
      next->begin(free.back());
      free.pop_back();
      if (!ended(&*next)) active.push_back(&*next);
    }
    if (active.empty()) return;
    std::vector<std::int64_t> sequences;
    for (const DanceInMaking* dance : active) sequences.push_back(dance->sequence());
    const auto& logits = decoder_->logits(sequences);
    for (std::size_t i = 0; i < active.size(); ++i) active[i]->choose(logits[i]);
  }
}

}  // namespace mocaplm
