// The pieces that a model of motion speaks (tokenizer/pieces.h learns them): tokens of one or more
// characters of a frame. Read from SentencePiece's file and encoded without its library, in the
// same pieces as it would (a test holds them together).
//
// Ids: those of the tokenizer up to its last bin mean what they always do, so every character is a
// token of its own; behind them come the pieces of two or more characters, and then the tokenizer's
// label values, moved up by count().
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "tokenizer/tokenizer.h"

namespace mocaplm {

// A stream of whole frames in pieces.
struct PieceStream {
  std::vector<std::int32_t> tokens;
  std::vector<std::size_t> starts;  // of each token, the index of its first character; then the end
  std::vector<std::size_t> frames;  // of each frame, the index of its first token; then the end

  std::size_t frame_count() const { return frames.empty() ? 0 : frames.size() - 1; }
  // Whole frames from `frame` on that have no more than `room` tokens.
  std::size_t frames_within(std::size_t frame, std::size_t room) const;
};

class PieceVocabulary {
 public:
  struct Characters {  // ids of the tokenizer: bins, the separator at most as the last one
    const std::int32_t* data;
    std::size_t size;
    std::int32_t operator[](std::size_t i) const { return data[i]; }
    std::int32_t last() const { return data[size - 1]; }
  };

  PieceVocabulary() = default;  // no pieces: every character is a token
  // Throws DataError naming `place` when it is no SentencePiece model, or one of other characters
  // than the tokenizer's, with a space inside a piece, or longer than a frame.
  PieceVocabulary(const std::string& bytes, const Tokenizer& tokenizer, const std::string& place);
  // The pieces of the model in `folder`, whose config repeats their fingerprint; "" for none.
  static PieceVocabulary of_model(const std::string& bytes, const Tokenizer& tokenizer,
                                  const std::string& fingerprint, const std::string& folder);

  bool any() const { return longest_ > 1; }
  bool bpe() const { return bpe_; }
  std::int64_t learnt() const { return learnt_; }  // pieces in the file, single characters included
  std::int32_t count() const { return count_; }    // of two or more characters
  int longest() const { return longest_; }         // characters of the longest
  // Of pieces and tokenizer together.
  const std::string& fingerprint() const { return fingerprint_; }

  // One past the last id that stands for characters.
  std::int32_t end() const { return static_cast<std::int32_t>(begin_.size()) - 1; }
  // Of an id in [kSeparator, end()).
  Characters characters(std::int32_t token) const {
    const auto t = static_cast<std::size_t>(token);
    return {characters_.data() + begin_[t], begin_[t + 1] - begin_[t]};
  }
  // Whether a token may come where `channel` (channels() for the separator) is next: it must not
  // reach beyond the frame, and the separator stands behind the last channel and nowhere else.
  bool fits(std::int32_t token, int channel) const;
  // The model's id of a tokenizer's id: label values are moved up.
  std::int32_t id(std::int32_t of_tokenizer) const {
    return of_tokenizer < first_label_ ? of_tokenizer : of_tokenizer + count_;
  }
  std::vector<std::int32_t> ids(std::vector<std::int32_t> of_tokenizer) const;

  // The one way of cutting a frame (bins and separator) into pieces that training sees.
  void encode_frame(const std::int32_t* frame, std::vector<std::int32_t>& tokens) const;
  // Whole frames.
  PieceStream encode(const std::vector<std::int32_t>& ids) const;

 private:
  void add(const std::vector<std::int32_t>& characters, float score, const std::string& place);
  void join_pairs();
  std::int32_t child(std::int32_t node, std::int32_t character) const;
  void encode_bpe(const std::int32_t* frame, std::vector<std::int32_t>& tokens) const;
  void encode_unigram(const std::int32_t* frame, std::vector<std::int32_t>& tokens) const;

  bool bpe_ = false;
  std::int64_t learnt_ = 0;
  std::int32_t count_ = 0, first_label_ = 0;
  int longest_ = 1, channels_ = 0;
  std::string fingerprint_;
  std::vector<std::int32_t> characters_;  // of all tokens, one after the other
  std::vector<std::size_t> begin_;        // of each token in characters_; then the end
  std::vector<float> score_;              // of each token
  float unknown_score_ = 0;               // of a character that was not learnt
  std::vector<bool> known_;               // of each token
  // Trie of all tokens: node 0 is the root.
  std::unordered_map<std::uint64_t, std::int32_t> children_;  // node << 32 | character
  std::vector<std::int32_t> token_at_;                        // of a node, -1 for none
  std::unordered_map<std::uint64_t, std::int32_t> joined_;    // left << 32 | right -> piece
};

}  // namespace mocaplm
