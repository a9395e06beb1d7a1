// The characters that stand for bins in a text corpus. Bin b has the same character whatever the
// number of bins: a tokenizer with fewer bins uses a prefix of one fixed list.
#pragma once

#include <string>
#include <string_view>

namespace mocaplm {

// Distinct printable characters, none of them a space, a combining mark or a control:
// ASCII 33..126, then Latin, Greek, Cyrillic and Armenian letters, then CJK ideographs. None is
// altered by Unicode normalisation (NFC).
constexpr int kAlphabetSize = 4096;

// Unicode code point of a bin's character; bin in [0, kAlphabetSize).
char32_t bin_character(int bin);
// The bin of a code point, or -1 when it stands for none.
int character_bin(char32_t character);

// Appends the UTF-8 form of a code point.
void append_utf8(std::string& text, char32_t character);
// Reads the code point at byte `at` and moves past it; false, with `at` unchanged, where the bytes
// are not well-formed UTF-8 (overlong forms, surrogates and values past U+10FFFF are not).
bool next_utf8(std::string_view text, std::size_t& at, char32_t& character);

}  // namespace mocaplm
