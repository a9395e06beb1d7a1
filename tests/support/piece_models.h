// Pieces without SentencePiece, which cannot live beside LibTorch: its file written byte by byte,
// with pieces cut at random from what a tokenizer writes.
#pragma once

#include <cstring>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/random.h"
#include "tokenizer/alphabet.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

// A SentencePiece model (tokenizer/sentencepiece_file.h) of these texts and scores, after one for
// the unknown.
inline std::string sentencepiece_bytes(bool bpe,
                                       const std::vector<std::pair<std::string, float>>& pieces) {
  const auto field = [](char key, const std::string& text) {  // texts of less than 16,384 bytes
    std::string bytes(1, key);
    if (text.size() > 0x7F) bytes += static_cast<char>((text.size() & 0x7F) | 0x80);
    bytes += static_cast<char>(text.size() > 0x7F ? text.size() >> 7 : text.size());
    return bytes + text;
  };
  const auto piece = [&](const std::string& text, float score, char type) {
    std::string number(4, '\0');
    std::memcpy(number.data(), &score, 4);
    return field('\x0A', field('\x0A', text) + "\x15" + number + "\x18" + std::string(1, type));
  };
  std::string bytes = piece("<unk>", 0, 2);
  for (const auto& [text, score] : pieces) bytes += piece(text, score, 1);
  return bytes + field('\x12', std::string("\x18") + (bpe ? '\x02' : '\x01'));
}

// Up to `count` pieces of 2 to 4 characters of the streams' frames, and all single characters.
inline std::string random_piece_bytes(const Tokenizer& tokenizer,
                                      const std::vector<std::vector<std::int32_t>>& streams,
                                      int count, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<std::pair<std::string, float>> pieces;
  const std::string space = "\xE2\x96\x81";
  const auto add = [&](const std::int32_t* ids, std::size_t size, float score) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i)
      ids[i] == Tokenizer::kSeparator ? void(text += space)
                                      : append_utf8(text, bin_character(ids[i] - 4));
    pieces.emplace_back(text, score);
  };
  for (std::int32_t id = Tokenizer::kSeparator; id < Tokenizer::kFirstBin + tokenizer.bins(); ++id)
    add(&id, 1, -10);
  std::set<std::vector<std::int32_t>> there;
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  for (int i = 0; i < count; ++i) {
    const auto& ids = streams[random.below(streams.size())];
    const std::size_t size = 2 + random.below(3), at = random.below(ids.size() - size);
    if (at / per_frame != (at + size - 1) / per_frame) continue;
    const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(at);
    if (there.insert({begin, begin + static_cast<std::ptrdiff_t>(size)}).second)
      add(&ids[at], size, -8 - static_cast<float>(random.uniform()));
  }
  return sentencepiece_bytes(false, pieces);
}

}  // namespace mocaplm
