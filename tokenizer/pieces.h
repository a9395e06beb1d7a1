// Pieces of words (Kudo and Richardson 2018, SentencePiece): characters that often follow each
// other become one token, by byte pair encoding or by a unigram language model. Learnt on a text
// corpus of any tokenizer of ours; a piece never reaches beyond a word, its last one holds the
// space after it. Loss-free: every text of the tokenizer's characters comes back as it was.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace mocaplm {

struct PieceConfig {
  std::int64_t bpe = 0, unigram = 0;  // number of pieces, 0 for none

  bool any() const { return bpe > 0 || unigram > 0; }
  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("bpe", bpe, 0, 65536, "pieces of words by byte pair encoding, 0 for none");
    v.integer("unigram", unigram, 0, 65536, "pieces of words by a unigram model, 0 for none");
  }
};

class Pieces {
 public:
  // Learns from lines of words, which end with a space. Every character of `alphabet` is a piece of
  // its own, too, seen or not; so are the space and one that no text holds, for the unknown. Throws
  // UsageError when both or no kinds are asked for, when there is no text, or when there are fewer
  // pieces than characters; DataError when the library gives up.
  static Pieces train(const PieceConfig& config, const std::vector<std::string>& lines,
                      const std::string& alphabet);

  int size() const;  // at most what was asked for: a small text has no more
  // The line's pieces. Throws DataError for characters outside the alphabet.
  std::vector<std::int32_t> encode(const std::string& line) const;
  // Throws DataError for numbers that are no piece.
  std::string decode(const std::vector<std::int32_t>& pieces) const;
  // The characters that a piece stands for, with its space.
  std::string text(std::int32_t piece) const;

  // SentencePiece's own model file.
  const std::string& bytes() const;
  void save(const std::filesystem::path& path) const;
  static Pieces load(const std::filesystem::path& path);
  std::string fingerprint() const;

 private:
  struct Model;
  explicit Pieces(std::string bytes, const std::string& place);
  std::shared_ptr<const Model> model_;
};

}  // namespace mocaplm
