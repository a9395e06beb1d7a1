#include "tokenizer/piece_vocabulary.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "common/error.h"
#include "common/random.h"
#include "tokenizer/alphabet.h"
#include "tokenizer/sentencepiece_file.h"

namespace mocaplm {

namespace {

constexpr char32_t kSpace = 0x2581;      // SentencePiece's sign for a space
constexpr float kUnknownPenalty = 10.f;  // below the worst piece: SentencePiece's constant

std::uint64_t key(std::int32_t first, std::int32_t second) {
  return static_cast<std::uint64_t>(first) << 32 | static_cast<std::uint32_t>(second);
}

// The tokenizer's ids of a piece's characters.
std::vector<std::int32_t> piece_characters(const std::string& text, int bins,
                                           const std::string& place) {
  std::vector<std::int32_t> ids;
  std::size_t at = 0;
  for (char32_t c = 0; next_utf8(text, at, c);) {
    const int bin = character_bin(c);
    if (c != kSpace && (bin < 0 || bin >= bins))
      throw DataError(in_file(place), "the piece \"" + text +
                                          "\" has a character that this tokenizer does not write");
    if (!ids.empty() && ids.back() == Tokenizer::kSeparator)
      throw DataError(in_file(place), "the piece \"" + text + "\" goes on after its word's end");
    ids.push_back(c == kSpace ? Tokenizer::kSeparator : Tokenizer::kFirstBin + bin);
  }
  if (ids.empty() || at != text.size())
    throw DataError(in_file(place), "the piece \"" + text + "\" is no text");
  return ids;
}

}  // namespace

std::size_t PieceStream::frames_within(std::size_t frame, std::size_t room) const {
  const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(frame);
  const auto end = std::upper_bound(begin, frames.end(), *begin + room);
  return static_cast<std::size_t>(end - begin) - 1;
}

PieceVocabulary::PieceVocabulary(const std::string& bytes, const Tokenizer& tokenizer,
                                 const std::string& place)
    : first_label_(Tokenizer::kFirstBin + tokenizer.bins()),
      channels_(tokenizer.channels()),
      fingerprint_(hex(stable_hash(bytes, stable_hash(tokenizer.fingerprint())))),
      begin_{0},
      token_at_{-1} {
  const SentencePieceFile file = parse_sentencepiece(bytes, place);
  bpe_ = file.bpe;
  learnt_ = static_cast<std::int64_t>(file.pieces.size());
  for (std::int32_t id = 0; id < first_label_; ++id) add({id}, 0, place);
  known_.assign(begin_.size() - 1, false);
  float worst = std::numeric_limits<float>::max();
  for (const SentencePieceFile::Piece& piece : file.pieces) {
    if (!piece.normal) continue;
    worst = std::min(worst, piece.score);
    const std::vector<std::int32_t> ids = piece_characters(piece.text, tokenizer.bins(), place);
    if (ids.size() == 1)
      score_[static_cast<std::size_t>(ids[0])] = piece.score;
    else
      add(ids, piece.score, place);
    known_.resize(begin_.size() - 1, true);
    if (ids.size() == 1) known_[static_cast<std::size_t>(ids[0])] = true;
  }
  unknown_score_ = worst - kUnknownPenalty;
  count_ = end() - first_label_;
  join_pairs();
}

PieceVocabulary PieceVocabulary::of_model(const std::string& bytes, const Tokenizer& tokenizer,
                                          const std::string& fingerprint,
                                          const std::string& folder) {
  if (bytes.empty() && fingerprint.empty()) return {};
  PieceVocabulary pieces(bytes, tokenizer, folder + "/pieces.model");
  if (pieces.fingerprint() != fingerprint)
    throw DataError(in_file(folder),
                    "pieces.model is not what this model was trained with (fingerprint " +
                        pieces.fingerprint() + ", expected " + fingerprint + ")");
  return pieces;
}

void PieceVocabulary::add(const std::vector<std::int32_t>& characters, float score,
                          const std::string& place) {
  if (static_cast<int>(characters.size()) > channels_ + 1)
    throw DataError(in_file(place), "has a piece of " + std::to_string(characters.size()) +
                                        " characters; a frame of this tokenizer has " +
                                        std::to_string(channels_ + 1));
  std::int32_t node = 0;
  for (const std::int32_t c : characters) {
    const auto [found, fresh] =
        children_.try_emplace(key(node, c), static_cast<std::int32_t>(token_at_.size()));
    if (fresh) token_at_.push_back(-1);
    node = found->second;
  }
  std::int32_t& token = token_at_[static_cast<std::size_t>(node)];
  if (token >= 0) throw DataError(in_file(place), "has the same piece twice");
  token = static_cast<std::int32_t>(score_.size());
  characters_.insert(characters_.end(), characters.begin(), characters.end());
  begin_.push_back(characters_.size());
  score_.push_back(score);
  longest_ = std::max(longest_, static_cast<int>(characters.size()));
}

// Every two tokens whose characters together are a piece.
void PieceVocabulary::join_pairs() {
  const auto find = [&](const std::int32_t* from, const std::int32_t* to) {
    std::int32_t node = 0;
    for (; from != to && node >= 0; ++from) node = child(node, *from);
    return node < 0 ? -1 : token_at_[static_cast<std::size_t>(node)];
  };
  for (std::int32_t token = first_label_; token < end(); ++token) {
    const Characters all = characters(token);
    for (std::size_t cut = 1; cut < all.size; ++cut) {
      const std::int32_t left = find(all.data, all.data + cut),
                         right = find(all.data + cut, all.data + all.size);
      if (left >= 0 && right >= 0) joined_[key(left, right)] = token;
    }
  }
}

std::int32_t PieceVocabulary::child(std::int32_t node, std::int32_t character) const {
  const auto found = children_.find(key(node, character));
  return found == children_.end() ? -1 : found->second;
}

bool PieceVocabulary::fits(std::int32_t token, int channel) const {
  const Characters all = characters(token);
  const int after = channel + static_cast<int>(all.size);
  return all.last() == Tokenizer::kSeparator ? after == channels_ + 1 : after <= channels_;
}

std::vector<std::int32_t> PieceVocabulary::ids(std::vector<std::int32_t> of_tokenizer) const {
  for (std::int32_t& one : of_tokenizer) one = id(one);
  return of_tokenizer;
}

// The pair whose piece was learnt first is joined first, the leftmost of equals; until none is left
// (SentencePiece's agenda visits them in the same order).
void PieceVocabulary::encode_bpe(const std::int32_t* frame,
                                 std::vector<std::int32_t>& tokens) const {
  const auto joined = [&](std::int32_t left, std::int32_t right) {
    const auto found = joined_.find(key(left, right));
    return found == joined_.end() ? -1 : found->second;
  };
  std::vector<std::int32_t> word(frame, frame + channels_ + 1), pair;
  for (std::size_t i = 0; i + 1 < word.size(); ++i) pair.push_back(joined(word[i], word[i + 1]));
  for (;;) {
    std::size_t best = pair.size();
    for (std::size_t i = 0; i < pair.size(); ++i)
      if (pair[i] >= 0 && (best == pair.size() || score_[static_cast<std::size_t>(pair[i])] >
                                                      score_[static_cast<std::size_t>(pair[best])]))
        best = i;
    if (best == pair.size()) break;
    const auto at = static_cast<std::ptrdiff_t>(best);
    word[best] = pair[best];
    word.erase(word.begin() + at + 1);
    pair.erase(pair.begin() + at);
    if (best > 0) pair[best - 1] = joined(word[best - 1], word[best]);
    if (best < pair.size()) pair[best] = joined(word[best], word[best + 1]);
  }
  tokens.insert(tokens.end(), word.begin(), word.end());
}

// The pieces whose scores (log-probabilities) have the largest sum (Viterbi), with SentencePiece's
// rounding: sums are kept as floats.
void PieceVocabulary::encode_unigram(const std::int32_t* frame,
                                     std::vector<std::int32_t>& tokens) const {
  struct Best {
    float score = 0;
    std::int32_t token = -1;  // that ends here
  };
  const std::size_t size = static_cast<std::size_t>(channels_) + 1;
  std::vector<Best> best(size + 1);
  for (std::size_t from = 0; from < size; ++from) {
    std::int32_t node = 0;
    for (std::size_t to = from; to < size; ++to) {
      if ((node = child(node, frame[to])) < 0) break;
      const std::int32_t token = token_at_[static_cast<std::size_t>(node)];
      if (token < 0) continue;
      const auto t = static_cast<std::size_t>(token);
      const double score = static_cast<double>(known_[t] ? score_[t] : unknown_score_) +
                           static_cast<double>(best[from].score);
      Best& there = best[to + 1];
      if (there.token < 0 || score > there.score) there = {static_cast<float>(score), token};
    }
  }
  const std::size_t before = tokens.size();
  for (std::size_t at = size; at > 0; at -= characters(tokens.back()).size)
    tokens.push_back(best[at].token);
  std::reverse(tokens.begin() + static_cast<std::ptrdiff_t>(before), tokens.end());
}

void PieceVocabulary::encode_frame(const std::int32_t* frame,
                                   std::vector<std::int32_t>& tokens) const {
  bpe_ ? encode_bpe(frame, tokens) : encode_unigram(frame, tokens);
}

PieceStream PieceVocabulary::encode(const std::vector<std::int32_t>& ids) const {
  const std::size_t per_frame = static_cast<std::size_t>(channels_) + 1;
  assert(ids.size() % per_frame == 0);
  PieceStream stream;
  stream.starts = stream.frames = {0};
  for (std::size_t at = 0; at < ids.size(); at += per_frame) {
    const std::size_t before = stream.tokens.size();
    encode_frame(ids.data() + at, stream.tokens);
    for (std::size_t i = before; i < stream.tokens.size(); ++i)
      stream.starts.push_back(stream.starts.back() + characters(stream.tokens[i]).size);
    stream.frames.push_back(stream.tokens.size());
  }
  return stream;
}

}  // namespace mocaplm
