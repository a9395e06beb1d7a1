// What a run starts from: data, tokenizer, model; fresh, fine-tuned or resumed.
#pragma once

#include "train/trainer.h"

namespace mocaplm {

struct TrainSetup {
  RunConfig config;
  Dataset dataset;
  Tokenizer tokenizer;
  std::string piece_bytes;  // SentencePiece's file; empty without pieces
  PieceVocabulary pieces;
  ModelDescription description;
  std::shared_ptr<LanguageModel> model;
  Corpus train, validation;

  StreamEncoding encoding() const { return {tokenizer, description.conditions, &pieces}; }
};

// Throws UsageError or DataError when the pieces do not fit together.
TrainSetup set_up_training(const TrainOptions& options);

// Weighs the clips as the settings ask.
void balance_corpus(const TrainSetup& setup, Corpus& corpus);

}  // namespace mocaplm
