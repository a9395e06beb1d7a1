// From prompts to dances (thesis 4.6): prompted channels are kept as given, all others are filled
// in one token after the other; several dances are decoded side by side.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "generate/decoder.h"
#include "generate/plan.h"
#include "tokenizer/piece_vocabulary.h"

namespace mocaplm {

struct GenerateResult {
  Clip clip;                // at the tokenizer's rate, labelled with the conditions
  Clip context;             // the prompt at the same rate and length of use (empty without one)
  std::vector<int> joints;  // prompted joints that the model has
  std::vector<std::string> notes;  // what the user should know (resampled, joints left free, ...)
  double frozen = 0;               // share of frames in which nothing moves more than one bin
  double context_frozen = 0;       // the same of the prompt
};

// A frame, told as soon as it is there.
struct GeneratedFrame {
  std::size_t dance;          // index of its request
  std::size_t index, frames;  // which of how many
  Clip pose;                  // one frame
};

class DanceInMaking;

class Generator {
 public:
  // Throws DataError when model and tokenizer do not belong together.
  Generator(const StoredModel& model, const std::string& place, const EngineOptions& options = {});

  using OnFrame = std::function<void(const GeneratedFrame&)>;
  // One result a request, in their order. As many dances are decoded together as the decoder has
  // sequences, and each is what it would be alone. Throws UsageError for joints the model does not
  // have and requests that cannot be, DataError for labels it does not know, each with what it does
  // know, before anything is computed.
  std::vector<GenerateResult> generate(const std::vector<GenerateRequest>& requests,
                                       const OnFrame& on_frame = nullptr);
  GenerateResult generate(const GenerateRequest& request, const OnFrame& on_frame = nullptr);

  const Tokenizer& tokenizer() const { return tokenizer_; }
  const ModelDescription& description() const { return decoder_->description(); }

 private:
  void decode(std::vector<DanceInMaking>& dances);

  std::unique_ptr<Decoder> decoder_;
  Tokenizer tokenizer_;
  PieceVocabulary pieces_;
};

}  // namespace mocaplm
