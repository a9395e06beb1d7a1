#include "common/pattern.h"

#include <gtest/gtest.h>

#include "common/error.h"

namespace mocaplm::pattern_test {
namespace {

using Named = std::vector<std::pair<std::string, std::string>>;

TEST(Pattern, NamedGroupsBothWaysOfWriting) {
  const Pattern pattern("^dataset-[12]_(?<content>[a-z-]+)_(?P<style>[a-z-]+)_(\\d{3})\\.bvh$",
                        "--x");
  EXPECT_EQ(pattern.names(), (std::vector<std::string>{"content", "style"}));
  const auto match = pattern.search("dataset-2_walk-turn-left_not-confident_041.bvh");
  ASSERT_TRUE(match);
  EXPECT_EQ(match->named, (Named{{"content", "walk-turn-left"}, {"style", "not-confident"}}));
  EXPECT_EQ(match->groups, (std::vector<std::string>{"walk-turn-left", "not-confident", "041"}));
  EXPECT_FALSE(pattern.search("walk_041.bvh"));
}

TEST(Pattern, GroupsThatTookNoPartAreLeftOut) {
  const Pattern pattern("(?<d>cmu|bandai)/(?:(?<genre>salsa|indian)/)?", "--x");
  EXPECT_EQ(pattern.search("cmu/salsa/01.bvh")->named, (Named{{"d", "cmu"}, {"genre", "salsa"}}));
  EXPECT_EQ(pattern.search("bandai/x.bvh")->named, (Named{{"d", "bandai"}}));
}

TEST(Pattern, BracketsAndEscapesAreNoGroups) {
  const Pattern pattern("[(]?\\((?<a>[^)(]+)\\)(?=x)", "--x");
  EXPECT_EQ(pattern.search("((abc)x")->named, (Named{{"a", "abc"}}));
}

void expect_refused(const std::string& expression) {
  EXPECT_THROW(Pattern(expression, "--x"), UsageError) << expression;
}

TEST(Pattern, RefusesWhatItCannotRead) {
  expect_refused("");
  expect_refused("(");
  expect_refused("(?<a");
  expect_refused("(?<>x)");
  expect_refused("(?<a b>x)");
  expect_refused("(?<a>x)(?<a>y)");
  expect_refused("(?<=x)y");
  expect_refused("(a)\\1");
  expect_refused("[");
  expect_refused("a{2,1}");
  expect_refused(std::string(2000, 'a'));
  expect_refused(std::string(20, '(') + std::string(20, ')'));
  expect_refused("((((a{999}){999}){999}){999})");
}

TEST(Pattern, StopsWhenItTakesTooLong) {
  for (const char* slow :
       {"(a+)+$", "(a|a)*$", "(?:a*)*b", "(.*)*(.*)*(.*)*c", "((((a?)*)*)*)*b"}) {
    const Pattern pattern(slow, "--x");
    try {
      EXPECT_FALSE(pattern.search(std::string(60, 'a') + "!")) << slow;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("too long"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(Pattern("a", "--x").search(std::string(5000, 'b')), UsageError);
  try {  // deep recursion: it matches or is refused, but never overflows the stack
    EXPECT_TRUE(Pattern("^(((.)|b)*)*$", "--x").search(std::string(1000, 'b')));
  } catch (const UsageError&) {
  }
  EXPECT_TRUE(Pattern("^.*$", "--x").search(std::string(1000, 'b')));
}

}  // namespace
}  // namespace mocaplm::pattern_test
