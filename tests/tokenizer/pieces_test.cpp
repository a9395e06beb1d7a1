#include "tokenizer/pieces.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "common/random.h"
#include "support/refusal.h"
#include "tokenizer/alphabet.h"

namespace mocaplm::pieces_test {
namespace {

std::string alphabet(int count) {
  std::string text;
  for (int c = 0; c < count; ++c) append_utf8(text, bin_character(c));
  return text;
}

// Words in which a character is often one more than the one before, with spaces at their ends.
std::string random_line(std::uint64_t seed, int words, int characters) {
  Random random(seed);
  std::string line;
  for (int w = 0; w < words; ++w) {
    int at = static_cast<int>(random.below(static_cast<std::uint64_t>(characters)));
    for (int i = 0; i < 12; ++i) {
      append_utf8(line, bin_character(at));
      at = random.uniform() < 0.7
               ? (at + 1) % characters
               : static_cast<int>(random.below(static_cast<std::uint64_t>(characters)));
    }
    line += ' ';
  }
  return line;
}

std::vector<std::string> some_lines(int characters) {
  std::vector<std::string> lines;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    lines.push_back(random_line(seed, 60, characters));
  return lines;
}

std::size_t characters_of(const std::string& line) {
  std::size_t count = 0, at = 0;
  for (char32_t c = 0; next_utf8(line, at, c);) ++count;
  return count;
}

PieceConfig kind(bool unigram, std::int64_t size) {
  PieceConfig config;
  (unigram ? config.unigram : config.bpe) = size;
  return config;
}

TEST(Pieces, AreFewerThanCharactersAndLoseNothing) {
  for (const bool unigram : {false, true})
    for (const int characters : {20, 500}) {
      const Pieces pieces = Pieces::train(kind(unigram, characters + 200), some_lines(characters),
                                          alphabet(characters));
      EXPECT_LE(pieces.size(), characters + 200);
      EXPECT_GT(pieces.size(), characters + 50);
      for (const std::uint64_t seed : {1, 99}) {
        const std::string line = random_line(seed, 80, characters);
        const std::vector<std::int32_t> ids = pieces.encode(line);
        EXPECT_EQ(pieces.decode(ids), line);
        EXPECT_LT(ids.size(), characters_of(line));
        for (const std::int32_t id : ids) {
          const std::string text = pieces.text(id);
          const std::size_t space = text.find(' ');
          EXPECT_TRUE(space == std::string::npos || space + 1 == text.size())
              << "a piece ends with its word";
        }
      }
    }
}

TEST(Pieces, KnowEveryCharacterOfTheAlphabet) {
  for (const bool unigram : {false, true}) {
    const Pieces pieces = Pieces::train(kind(unigram, 500), some_lines(20), alphabet(400));
    std::string line = alphabet(400) + " ";
    EXPECT_EQ(pieces.decode(pieces.encode(line)), line) << "seen or not";
    EXPECT_PRED2(contains, refusal([&] { pieces.encode(alphabet(401) + " "); }), "not learnt with");
    EXPECT_EQ(pieces.decode(pieces.encode("!! \"")), "!! \"") << "the last space may be missing";
    EXPECT_TRUE(pieces.encode("").empty());
  }
}

// Characters that SentencePiece writes its own signs with are nothing special here.
TEST(Pieces, MarkupIsText) {
  std::vector<std::string> lines(50, "<s> </s> <unk> <pad> a<s>b @@ ## ");
  const Pieces pieces = Pieces::train(kind(false, 140), lines, alphabet(94));
  EXPECT_EQ(pieces.decode(pieces.encode(lines[0])), lines[0]);
  EXPECT_LT(pieces.encode(lines[0]).size(), lines[0].size());
}

TEST(Pieces, TheSameTextGivesTheSamePieces) {
  for (const bool unigram : {false, true}) {
    const Pieces a = Pieces::train(kind(unigram, 150), some_lines(20), alphabet(20));
    const Pieces b = Pieces::train(kind(unigram, 150), some_lines(20), alphabet(20));
    EXPECT_EQ(a.fingerprint(), b.fingerprint());
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / "mocaplm_pieces_test.model";
    a.save(file);
    const Pieces c = Pieces::load(file);
    EXPECT_EQ(c.fingerprint(), a.fingerprint());
    EXPECT_EQ(c.encode(some_lines(20)[3]), a.encode(some_lines(20)[3]));
    put(file.string(), "no model");
    EXPECT_PRED2(contains, refusal([&] { Pieces::load(file); }), "is not a SentencePiece model");
    std::filesystem::remove(file);
  }
}

TEST(Pieces, RefuseWhatCannotBe) {
  const auto says = [](const PieceConfig& config, const std::vector<std::string>& lines,
                       const std::string& part) {
    EXPECT_PRED2(contains, refusal<UsageError>([&] { Pieces::train(config, lines, alphabet(20)); }),
                 part);
  };
  says({}, some_lines(20), "give one");
  says({100, 100}, some_lines(20), "give one");
  says({100, 0}, {}, "no text");
  says({5, 0}, some_lines(20), "5 pieces");
  const Pieces pieces = Pieces::train(kind(false, 100), some_lines(20), alphabet(20));
  for (const std::int32_t id : {-1, 0, pieces.size()})
    EXPECT_PRED2(contains, refusal([&] { pieces.decode({id}); }), "is no piece");
}

}  // namespace
}  // namespace mocaplm::pieces_test
