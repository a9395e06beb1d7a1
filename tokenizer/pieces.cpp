#include "tokenizer/pieces.h"

#include <sentencepiece_processor.h>
#include <sentencepiece_trainer.h>

#include <unordered_map>

#include "common/error.h"
#include "common/files.h"
#include "common/random.h"
#include "tokenizer/alphabet.h"

namespace mocaplm {

namespace {

constexpr const char* kSpace = "\xE2\x96\x81";    // U+2581, SentencePiece's sign for a space
constexpr const char* kUnknown = "\xE2\x81\x87";  // U+2047: no character of ours, nor made of them

class Lines : public sentencepiece::SentenceIterator {
 public:
  explicit Lines(const std::vector<std::string>& lines) : lines_(lines) {}
  bool done() const override { return at_ >= lines_.size(); }
  void Next() override { ++at_; }
  const std::string& value() const override { return lines_[at_]; }
  sentencepiece::util::Status status() const override { return {}; }

 private:
  const std::vector<std::string>& lines_;
  std::size_t at_ = 0;
};

// Spaces for SentencePiece's signs.
std::string with_spaces(const std::string& piece) {
  std::string text;
  for (std::size_t at = 0; at < piece.size();)
    if (piece.compare(at, 3, kSpace) == 0) {
      text += ' ';
      at += 3;
    } else {
      text += piece[at++];
    }
  return text;
}

// Every character as a word of its own, so that all are known. SentencePiece leaves out the rarest
// ones when their share is lost in a float's rounding, so there are more of them in a long text.
void add_alphabet(const std::string& alphabet, std::vector<std::string>& words) {
  std::size_t bytes = 0;
  for (const std::string& word : words) bytes += word.size();
  std::size_t at = 0, from = 0;
  for (char32_t c = 0; next_utf8(alphabet, at, c); from = at)
    words.insert(words.end(), 1 + bytes / 4000000, alphabet.substr(from, at - from));
}

}  // namespace

struct Pieces::Model {
  std::string bytes;
  sentencepiece::SentencePieceProcessor processor;
  std::vector<std::string> texts;
};

Pieces::Pieces(std::string bytes, const std::string& place) {
  auto model = std::make_shared<Model>();
  model->bytes = std::move(bytes);
  const auto status = model->processor.LoadFromSerializedProto(model->bytes);
  if (!status.ok())
    throw DataError(in_file(place),
                    std::string("is not a SentencePiece model: ") + status.error_message());
  for (int id = 0; id < model->processor.GetPieceSize(); ++id)
    model->texts.push_back(with_spaces(model->processor.IdToPiece(id)));
  model_ = std::move(model);
}

Pieces Pieces::train(const PieceConfig& config, const std::vector<std::string>& lines,
                     const std::string& alphabet) {
  if ((config.bpe > 0) == (config.unigram > 0))
    throw UsageError("pieces come from byte pair encoding (bpe) or from a unigram model: give one");
  // A sentence a word: pieces stay inside words anyway, and lines may be long.
  std::vector<std::string> words;
  for (const std::string& line : lines)
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t end = std::min(line.find(' ', at), line.size() - 1);
      words.push_back(line.substr(at, end + 1 - at));
      at = end + 1;
    }
  if (words.empty()) throw UsageError("there is no text to learn pieces from");
  add_alphabet(alphabet, words);
  const std::int64_t size = std::max(config.bpe, config.unigram);
  const std::unordered_map<std::string, std::string> settings = {
      {"model_type", config.bpe > 0 ? "bpe" : "unigram"},
      {"vocab_size", std::to_string(size)},
      {"hard_vocab_limit", "false"},
      {"character_coverage", "1.0"},
      {"normalization_rule_name", "identity"},
      {"add_dummy_prefix", "false"},
      {"remove_extra_whitespaces", "false"},
      {"treat_whitespace_as_suffix", "true"},
      {"split_by_unicode_script", "false"},
      {"split_by_number", "false"},
      {"max_sentencepiece_length", "64"},
      {"max_sentence_length", "1000000"},
      {"num_threads", "1"},
      {"unk_piece", kUnknown},
      {"bos_id", "-1"},
      {"eos_id", "-1"},
      {"pad_id", "-1"},
      {"minloglevel", "2"}};
  Lines iterator(words);
  std::string bytes;
  const auto status = sentencepiece::SentencePieceTrainer::Train(settings, &iterator, &bytes);
  if (!status.ok())
    throw UsageError("no " + std::to_string(size) +
                     " pieces can be learnt: " + status.error_message());
  return Pieces(std::move(bytes), "the pieces just learnt");
}

int Pieces::size() const {
  return static_cast<int>(model_->texts.size());
}

std::vector<std::int32_t> Pieces::encode(const std::string& line) const {
  std::vector<std::int32_t> all;
  std::vector<int> word;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size() - 1);
    const auto status = model_->processor.Encode(line.substr(at, end + 1 - at), &word);
    if (!status.ok()) throw DataError(in_file("pieces"), status.error_message());
    for (const int id : word) {
      if (model_->processor.IsUnknown(id))
        throw DataError(Place{"pieces", "byte " + std::to_string(at)},
                        "the word \"" + line.substr(at, end - at) +
                            "\" holds a character that the pieces were not learnt with");
      all.push_back(id);
    }
    at = end + 1;
  }
  return all;
}

std::string Pieces::text(std::int32_t piece) const {
  if (piece < 0 || piece >= size() || model_->processor.IsUnknown(piece))
    throw DataError(in_file("pieces"),
                    std::to_string(piece) + " is no piece; there are " + std::to_string(size()));
  return model_->texts[static_cast<std::size_t>(piece)];
}

std::string Pieces::decode(const std::vector<std::int32_t>& pieces) const {
  std::string line;
  for (const std::int32_t piece : pieces) line += text(piece);
  return line;
}

const std::string& Pieces::bytes() const {
  return model_->bytes;
}

void Pieces::save(const std::filesystem::path& path) const {
  write_file(path, model_->bytes);
}

Pieces Pieces::load(const std::filesystem::path& path) {
  return Pieces(read_file(path), path.string());
}

std::string Pieces::fingerprint() const {
  return hex(stable_hash(model_->bytes));
}

}  // namespace mocaplm
