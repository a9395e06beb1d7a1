#include "tokenizer/alphabet.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cwctype>
#include <set>

namespace mocaplm::alphabet_test {
namespace {

TEST(Alphabet, IsDistinctAscendingAndItsOwnInverse) {
  std::set<char32_t> seen;
  for (int bin = 0; bin < kAlphabetSize; ++bin) {
    const char32_t c = bin_character(bin);
    EXPECT_TRUE(seen.insert(c).second);
    EXPECT_EQ(character_bin(c), bin);
  }
  EXPECT_EQ(bin_character(0), U'!');
  EXPECT_EQ(bin_character(93), U'~');
  for (const char32_t c :
       {U' ', U'\n', U'\t', U'\u00A0', U'\u00AD', U'\u0301', U'\u2003', U'\u3000'})
    EXPECT_EQ(character_bin(c), -1) << static_cast<unsigned>(c);
}

TEST(Alphabet, IsPrintableByTheSystemsTables) {
  if (!std::setlocale(LC_CTYPE, "C.UTF-8")) GTEST_SKIP() << "no C.UTF-8 locale here";
  for (int bin = 0; bin < kAlphabetSize; ++bin) {
    const auto c = static_cast<wint_t>(bin_character(bin));
    EXPECT_TRUE(std::iswgraph(c)) << "U+" << std::hex << c;
    EXPECT_GE(wcwidth(static_cast<wchar_t>(c)), 1)
        << "U+" << std::hex << c;  // 0: combining or invisible
  }
}

TEST(Utf8, GoesThereAndBackForEveryScalarValue) {
  for (char32_t c = 0; c <= 0x10FFFF; ++c) {
    if (c >= 0xD800 && c <= 0xDFFF) continue;
    std::string text;
    append_utf8(text, c);
    std::size_t at = 0;
    char32_t back = 1;
    ASSERT_TRUE(next_utf8(text, at, back)) << std::hex << static_cast<unsigned>(c);
    ASSERT_EQ(back, c);
    ASSERT_EQ(at, text.size());
    // Cut anywhere, it is refused and nothing moves.
    for (std::size_t size = 1; size < text.size(); ++size) {
      at = 0;
      ASSERT_FALSE(next_utf8(std::string_view(text).substr(0, size), at, back));
      ASSERT_EQ(at, 0u);
    }
  }
}

TEST(Utf8, RefusesWhatIsNotWellFormed) {
  for (const std::string bytes :
       {"\x80", "\xC0\x80", "\xC1\xBF", "\xE0\x80\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80",
        "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80", "\xFF", "\xC3(", "\xE2\x28\xA1"}) {
    std::size_t at = 0;
    char32_t c = 0;
    EXPECT_FALSE(next_utf8(bytes, at, c)) << testing::PrintToString(bytes);
  }
}

}  // namespace
}  // namespace mocaplm::alphabet_test
