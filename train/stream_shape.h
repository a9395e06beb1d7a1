// The token stream of a model, as its tokenizer and its pieces write it.
#pragma once

#include "model/config.h"
#include "tokenizer/piece_vocabulary.h"

namespace mocaplm {

// Label values count, so ask when the tokenizer has them all. Without pieces every character is a
// token.
inline StreamShape stream_shape(const Tokenizer& tokenizer, const PieceVocabulary& pieces = {}) {
  return {tokenizer.vocabulary() + pieces.count(),
          Tokenizer::kFirstBin,
          tokenizer.bins(),
          tokenizer.channels(),
          pieces.count(),
          pieces.longest()};
}

}  // namespace mocaplm
