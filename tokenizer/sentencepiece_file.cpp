#include "tokenizer/sentencepiece_file.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "common/error.h"

namespace mocaplm {

namespace {

// The fields of one protobuf message, in their order.
class Fields {
 public:
  Fields(std::string_view bytes, std::size_t offset, const std::string& place)
      : bytes_(bytes), offset_(offset), place_(place) {}

  // Goes to the next field; false at the end.
  bool next() {
    if (at_ == bytes_.size()) return false;
    const std::uint64_t key = varint();
    number_ = key >> 3;
    switch (key & 7) {
      case 0:
        whole_ = varint();
        text_ = {};
        break;
      case 1:
        text_ = take(8);
        break;
      case 2:
        text_ = take(varint());
        break;
      case 5:
        text_ = take(4);
        break;
      default:
        fail("a field of unknown type");
    }
    return true;
  }
  std::uint64_t number() const { return number_; }
  std::uint64_t whole() const { return whole_; }
  std::string_view text() const { return text_; }
  float real() const {
    if (text_.size() != 4) fail("no number where a score should be");
    // Little-endian, as the machines that this runs on are.
    float value = 0;
    std::memcpy(&value, text_.data(), 4);
    if (!std::isfinite(value)) fail("a score that is not finite");
    return value;
  }
  Fields inside() const { return {text_, offset_ + at_ - text_.size(), place_}; }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw DataError(Place{place_, "byte " + std::to_string(offset_ + at_)},
                    "is not a SentencePiece model: " + what);
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      if (at_ == bytes_.size()) fail("it ends inside a number");
      const auto byte = static_cast<unsigned char>(bytes_[at_++]);
      value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if (byte < 0x80) return value;
    }
    fail("a number of more than 64 bits");
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size() - at_) fail("it ends inside a field");
    at_ += static_cast<std::size_t>(size);
    return bytes_.substr(at_ - static_cast<std::size_t>(size), static_cast<std::size_t>(size));
  }

  std::string_view bytes_, text_;
  std::size_t at_ = 0, offset_;
  std::uint64_t number_ = 0, whole_ = 0;
  const std::string& place_;
};

SentencePieceFile::Piece read_piece(Fields fields) {
  SentencePieceFile::Piece piece;
  while (fields.next()) {
    if (fields.number() == 1) piece.text = fields.text();
    if (fields.number() == 2) piece.score = fields.real();
    if (fields.number() == 3) piece.normal = fields.whole() == 1;
  }
  return piece;
}

}  // namespace

SentencePieceFile parse_sentencepiece(const std::string& bytes, const std::string& place) {
  SentencePieceFile file;
  std::uint64_t kind = 1;
  Fields fields(bytes, 0, place);
  while (fields.next()) {
    if (fields.number() == 1) file.pieces.push_back(read_piece(fields.inside()));
    if (fields.number() != 2) continue;
    for (Fields trainer = fields.inside(); trainer.next();)
      if (trainer.number() == 3) kind = trainer.whole();
  }
  if (file.pieces.empty())
    throw DataError(in_file(place), "is not a SentencePiece model: it holds no pieces");
  if (kind != 1 && kind != 2)
    throw DataError(in_file(place), "is a SentencePiece model of kind " + std::to_string(kind) +
                                        ", expected a unigram model (1) or BPE (2)");
  file.bpe = kind == 2;
  return file;
}

}  // namespace mocaplm
