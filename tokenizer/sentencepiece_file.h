// SentencePiece's .model file read without its library: that one brings its own copy of protobuf,
// whose symbols collide with those of the protobuf that LibTorch loads.
//
// A protobuf message (sentencepiece_model.proto): field 1, repeated, is a piece {1: text, 2: score
// (float), 3: type (1 normal, 2 unknown, ...)}; field 2 is how it was trained {3: model type, 1
// unigram (also when it is missing), 2 BPE}. All other fields are skipped.
#pragma once

#include <string>
#include <vector>

namespace mocaplm {

struct SentencePieceFile {
  struct Piece {
    std::string text;  // UTF-8, U+2581 for a space
    float score = 0;
    bool normal = true;  // neither unknown, control, nor otherwise special
  };
  bool bpe = false;  // else unigram
  std::vector<Piece> pieces;
};

// Throws DataError naming `place` and the byte where it is no such message, or for a kind of model
// that is neither BPE nor unigram.
SentencePieceFile parse_sentencepiece(const std::string& bytes, const std::string& place);

}  // namespace mocaplm
