#include <gtest/gtest.h>

#include "common/error.h"
#include "common/random.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm::tokenizer_text_test {
namespace {

Tokenizer with_bins(int bins) {
  TokenizerConfig config;
  config.root = "none";
  config.bins = bins;
  return Tokenizer::fit(config, {});
}

TEST(TokenizerText, RandomIdsGoToTextAndBack) {
  Random random(3);
  for (const int bins : {2, 94, 95, 360, 4096}) {
    const Tokenizer tokenizer = with_bins(bins);
    std::vector<std::int32_t> ids;
    for (int i = 0; i < 20000; ++i) {
      const auto token =
          static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(bins) + 1));
      ids.push_back(token == bins ? Tokenizer::kSeparator : Tokenizer::kFirstBin + token);
    }
    const std::string text = tokenizer.to_text(ids);
    EXPECT_EQ(tokenizer.from_text(text), ids);
    EXPECT_EQ(tokenizer.to_text(tokenizer.from_text(text)), text);
  }
}

TEST(TokenizerText, NamesLineAndCharacterOfWhatItDoesNotKnow) {
  const Tokenizer tokenizer = with_bins(200);
  const auto error_of = [&](const std::string& text) -> std::string {
    try {
      tokenizer.from_text(text, "corpus.txt");
    } catch (const DataError& error) {
      return error.what();
    }
    return "(no error)";
  };
  EXPECT_NE(error_of("a\xC3\xA9\xE4\xB8\x80")
                .find("corpus.txt: line 1, character 3: found '\xE4\xB8\x80' (U+4E00)"),
            std::string::npos)
      << error_of("a\xC3\xA9\xE4\xB8\x80");
  EXPECT_NE(error_of("ab\nc").find("character 3: found U+000A"), std::string::npos)
      << error_of("ab\nc");
  EXPECT_NE(error_of("ab\xFF").find("character 3: is not UTF-8"), std::string::npos);
  EXPECT_NE(error_of(std::string("a\0", 2)).find("character 2: found U+0000"), std::string::npos);
}

TEST(TokenizerText, OnlyBinsAndSeparatorsHaveCharacters) {
  EXPECT_THROW(with_bins(10).to_text({4, 5, Tokenizer::kMask}), DataError);
  EXPECT_THROW(with_bins(10).to_text({14}), DataError);
}

}  // namespace
}  // namespace mocaplm::tokenizer_text_test
