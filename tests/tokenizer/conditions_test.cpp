#include "tokenizer/conditions.h"

#include <gtest/gtest.h>

namespace mocaplm::conditions_test {
namespace {

TEST(Conditions, AreWhatTheModelKnows) {
  Tokenizer tokenizer;
  tokenizer.add_label_values("style", {"calm"});
  const Labels calm = {{"style", "calm"}, {"content", "walk"}};
  EXPECT_EQ(known_conditions(tokenizer, {"style"}, calm), (Labels{{"style", "calm"}}));
  EXPECT_EQ(known_conditions(tokenizer, {"style"}, {{"style", "wild"}}), Labels());
  EXPECT_EQ(known_conditions(tokenizer, {}, calm), Labels());
}

TEST(Conditions, OfTheWindowsHeadAreHiddenWhereTheyAreNotKnown) {
  Tokenizer tokenizer;
  tokenizer.add_label_values("style", {"calm", "wild"});
  tokenizer.add_label_values("content", {"walk"});
  const Labels labels = {{"style", "wild"}, {"content", "run"}};
  EXPECT_EQ(condition_prefix(tokenizer, {"content", "style", "dancer"}, labels),
            (std::vector<std::int32_t>{Tokenizer::kStart, Tokenizer::kMask,
                                       tokenizer.label_id("style", "wild"), Tokenizer::kMask}));
  EXPECT_EQ(condition_prefix(tokenizer, {}, labels), std::vector<std::int32_t>{Tokenizer::kStart});
}

}  // namespace
}  // namespace mocaplm::conditions_test
