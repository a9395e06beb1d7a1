#include <gtest/gtest.h>

#include "common/error.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm::labels_test {
namespace {

Tokenizer example() {
  TokenizerConfig config;
  config.root = "none";
  return Tokenizer::fit(config, {});
}

TEST(Labels, FollowTheBinsAndKeepEarlierIds) {
  Tokenizer tokenizer = example();
  const int first = Tokenizer::kFirstBin + 360;
  tokenizer.add_label_values("genre", {"waack", "krump"});
  tokenizer.add_label_values("dancer", {"d01", "d02", "d03"});
  EXPECT_EQ(tokenizer.vocabulary(), first + 5);
  EXPECT_EQ(tokenizer.label_id("genre", "waack"), first);
  EXPECT_EQ(tokenizer.label_id("dancer", "d03"), first + 4);
  tokenizer.add_label_values("genre", {"krump", "house", "pop"});
  EXPECT_EQ(tokenizer.label_id("genre", "krump"), first + 1);
  EXPECT_EQ(tokenizer.label_id("dancer", "d03"), first + 4);
  EXPECT_EQ(tokenizer.label_id("genre", "house"), first + 5);
  EXPECT_EQ(tokenizer.label_id("genre", "pop"), first + 6);
  EXPECT_EQ(tokenizer.vocabulary(), first + 7);
  EXPECT_FALSE(tokenizer.is_bin(tokenizer.label_id("genre", "waack")));
  EXPECT_EQ(Tokenizer::from_json(tokenizer.to_json(), "t").label_id("genre", "pop"), first + 6);
}

TEST(Labels, UnknownOnesAreAnsweredWithTheNearestKnown) {
  Tokenizer tokenizer = example();
  tokenizer.add_label_values("genre", {"waack", "krump"});
  EXPECT_TRUE(tokenizer.knows("genre", "waack"));
  EXPECT_FALSE(tokenizer.knows("genre", "waak"));
  EXPECT_FALSE(tokenizer.knows("style", "waack"));
  try {
    tokenizer.label_id("genre", "waak");
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"waack\""), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(tokenizer.label_id("style", "waack"), DataError);
  EXPECT_THROW(tokenizer.add_label_values("", {"x"}), UsageError);
  EXPECT_THROW(tokenizer.add_label_values("genre", {""}), UsageError);
}

}  // namespace
}  // namespace mocaplm::labels_test
