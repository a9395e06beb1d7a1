#include "tokenizer/alphabet.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace mocaplm {

namespace {

struct Range {
  char32_t first, last;
};

// Left out: U+00AD (soft hyphen, invisible), U+03A2 (unassigned), U+0483..0489 (combining).
constexpr Range kRanges[] = {{0x21, 0x7E},   {0xA1, 0xAC},    {0xAE, 0x2AF},  {0x391, 0x3A1},
                             {0x3A3, 0x3CE}, {0x400, 0x481},  {0x48A, 0x52F}, {0x531, 0x556},
                             {0x561, 0x586}, {0x4E00, 0x9FFF}};

std::array<char32_t, kAlphabetSize> make_alphabet() {
  std::array<char32_t, kAlphabetSize> all{};
  std::size_t size = 0;
  for (const Range& range : kRanges)
    for (char32_t c = range.first; c <= range.last && size < all.size(); ++c) all[size++] = c;
  assert(size == all.size());
  return all;
}

// Ascending, so that a character is found by bisection.
const std::array<char32_t, kAlphabetSize>& alphabet() {
  static const std::array<char32_t, kAlphabetSize> all = make_alphabet();
  return all;
}

}  // namespace

char32_t bin_character(int bin) {
  assert(bin >= 0 && bin < kAlphabetSize);
  return alphabet()[static_cast<std::size_t>(bin)];
}

int character_bin(char32_t character) {
  const auto& all = alphabet();
  const auto found = std::lower_bound(all.begin(), all.end(), character);
  return found != all.end() && *found == character ? static_cast<int>(found - all.begin()) : -1;
}

void append_utf8(std::string& text, char32_t c) {
  const auto continuation = [&](int shift) {
    text += static_cast<char>(0x80 | ((c >> shift) & 0x3F));
  };
  if (c < 0x80) {
    text += static_cast<char>(c);
  } else if (c < 0x800) {
    text += static_cast<char>(0xC0 | (c >> 6));
    continuation(0);
  } else if (c < 0x10000) {
    text += static_cast<char>(0xE0 | (c >> 12));
    continuation(6);
    continuation(0);
  } else {
    text += static_cast<char>(0xF0 | (c >> 18));
    continuation(12);
    continuation(6);
    continuation(0);
  }
}

bool next_utf8(std::string_view text, std::size_t& at, char32_t& character) {
  if (at >= text.size()) return false;
  const auto lead = static_cast<unsigned char>(text[at]);
  const int more = lead < 0x80 ? 0 : lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
  if ((lead >= 0x80 && lead < 0xC2) || lead > 0xF4) return false;
  if (text.size() - at <= static_cast<std::size_t>(more)) return false;
  char32_t c = more == 0 ? lead : lead & (0x3Fu >> more);
  for (int i = 1; i <= more; ++i) {
    const auto byte = static_cast<unsigned char>(text[at + static_cast<std::size_t>(i)]);
    if ((byte & 0xC0) != 0x80) return false;
    c = (c << 6) | (byte & 0x3F);
  }
  const char32_t least = more == 3 ? 0x10000 : more == 2 ? 0x800 : more == 1 ? 0x80 : 0;
  if (c < least || c > 0x10FFFF || (c >= 0xD800 && c <= 0xDFFF)) return false;
  at += static_cast<std::size_t>(more) + 1;
  character = c;
  return true;
}

}  // namespace mocaplm
