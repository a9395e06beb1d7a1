// Tokens as text: a bin is a character of the alphabet, the separator a space.
#include <cstdio>

#include "common/error.h"
#include "tokenizer/alphabet.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

namespace {

std::string show(char32_t character) {
  char code[24];
  std::snprintf(code, sizeof code, "U+%04X", static_cast<unsigned>(character));
  if (character < 0x20 || (character >= 0x7F && character < 0xA0)) return code;
  std::string text = "'";
  append_utf8(text, character);
  return text + "' (" + code + ")";
}

}  // namespace

std::string Tokenizer::describe(std::int32_t id) const {
  switch (id) {
    case kPad:
      return "the padding token";
    case kMask:
      return "the mask token";
    case kStart:
      return "the start token";
    case kSeparator:
      return "the separator";
    default:
      break;
  }
  if (is_bin(id)) return "bin " + std::to_string(id - kFirstBin);
  return (id >= kFirstBin && id < vocabulary() ? "condition token " : "unknown token ") +
         std::to_string(id);
}

std::string Tokenizer::to_text(const std::vector<std::int32_t>& ids) const {
  std::string text;
  text.reserve(2 * ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == kSeparator)
      text += ' ';
    else if (is_bin(ids[i]))
      append_utf8(text, bin_character(ids[i] - kFirstBin));
    else
      throw DataError(Place{"token stream", "token " + std::to_string(i)},
                      "found " + describe(ids[i]) +
                          ", which has no character; only bins and separators are text");
  }
  return text;
}

std::vector<std::int32_t> Tokenizer::from_text(const std::string& text, const std::string& name,
                                               std::size_t line) const {
  return characters_to_ids(text, bins(), name, line);
}

std::vector<std::int32_t> characters_to_ids(const std::string& text, int count,
                                            const std::string& name, std::size_t line) {
  std::vector<std::int32_t> ids;
  ids.reserve(text.size());
  std::size_t character = 1;
  for (std::size_t at = 0; at < text.size(); ++character) {
    const Place place{name,
                      "line " + std::to_string(line) + ", character " + std::to_string(character)};
    char32_t c = 0;
    if (!next_utf8(text, at, c)) throw DataError(place, "is not UTF-8 text");
    if (c == ' ') {
      ids.push_back(Tokenizer::kSeparator);
      continue;
    }
    const int bin = character_bin(c);
    if (bin < 0 || bin >= count)
      throw DataError(place, "found " + show(c) + ", which is " +
                                 (bin < 0 ? "not in the alphabet" : "bin " + std::to_string(bin)) +
                                 "; this tokenizer has " + std::to_string(count) + " bins, " +
                                 show(bin_character(0)) + " to " + show(bin_character(count - 1)));
    ids.push_back(Tokenizer::kFirstBin + bin);
  }
  return ids;
}

}  // namespace mocaplm
