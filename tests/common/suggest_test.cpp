// Slips of the hand and what was meant.
#include "common/suggest.h"

#include <gtest/gtest.h>

#include "common/random.h"
#include "common/text.h"

namespace mocaplm::suggest_test {
namespace {

// The definition (Boytsov 2011, equation 3.1), without a table: what the last letters became.
std::size_t plain_distance(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const std::string a1(a, 0, a.size() - 1), b1(b, 0, b.size() - 1);
  std::size_t fewest = std::min({plain_distance(a1, b) + 1, plain_distance(a, b1) + 1,
                                 plain_distance(a1, b1) + (a.back() == b.back() ? 0 : 1)});
  if (a.size() > 1 && b.size() > 1 && a.back() == b1.back() && a1.back() == b.back())
    fewest =
        std::min(fewest, plain_distance(a.substr(0, a.size() - 2), b.substr(0, b.size() - 2)) + 1);
  return fewest;
}

std::string random_word(Random& random) {
  std::string word;
  const std::uint64_t letters = random.below(7);
  for (std::uint64_t i = 0; i < letters; ++i) word += static_cast<char>('a' + random.below(3));
  return word;
}

TEST(EditDistance, IsTheDefinitions) {
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    const std::string a = random_word(random), b = random_word(random);
    ASSERT_EQ(edit_distance(a, b), plain_distance(a, b)) << a << " and " << b;
    ASSERT_EQ(edit_distance(a, b), edit_distance(b, a)) << a << " and " << b;
  }
}

TEST(EditDistance, OfKnownWords) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("genrate", "generate"), 1u);
  EXPECT_EQ(edit_distance("hosue", "house"), 1u);
  EXPECT_EQ(edit_distance("ca", "abc"), 3u);  // 2 if a letter could be changed twice
}

TEST(NearestName, IsWhatWasMeant) {
  const std::vector<std::string> genres = {"break", "house", "pop", "waack"};
  EXPECT_EQ(nearest_name("waak", genres), "waack");
  EXPECT_EQ(nearest_name("hosue", genres), "house");
  EXPECT_EQ(nearest_name("Waack", genres), "waack");
  EXPECT_EQ(nearest_name("poop", genres), "pop");
  EXPECT_EQ(did_you_mean("waak", genres), ", did you mean \"waack\"?");
}

TEST(NearestName, IsNoneWhereNothingIsNear) {
  EXPECT_EQ(nearest_name("krump", {"break", "house", "pop", "waack"}), "");
  EXPECT_EQ(nearest_name("BR", {"HO", "WA"}), "");  // short names are all near each other
  EXPECT_EQ(nearest_name("q", {"x", "y", "z"}), "");
  EXPECT_EQ(nearest_name("fish", {"bash", "zsh"}), "");  // half of a word is no slip
  EXPECT_EQ(nearest_name("", {"a"}), "");
  EXPECT_EQ(nearest_name(std::string(1000, 'a'), {std::string(1000, 'b')}), "");
  EXPECT_EQ(did_you_mean("krump", {"house"}), "");
}

TEST(NearestName, KnowsABeginning) {
  const std::vector<std::string> commands = {"classify", "evaluate", "experiment", "completion"};
  EXPECT_EQ(nearest_name("eval", commands), "evaluate");
  EXPECT_EQ(nearest_name("exp", commands), "experiment");
  EXPECT_EQ(nearest_name("e", commands), "");
  EXPECT_EQ(nearest_name("left", {"left_arm", "left_leg"}), "");
}

TEST(KnownNames, EndAMessage) {
  EXPECT_EQ(known_names("waak", {"pop", "waack"}), ", did you mean \"waack\"? Known: pop, waack");
  EXPECT_EQ(known_names("jazz", {"pop", "waack"}, "Genres"), ". Genres: pop, waack");
  // The nearest is found among all, also where the list is cut.
  std::vector<std::string> dancers;
  for (int i = 10; i < 100; ++i) dancers.push_back("dancer" + std::to_string(i));
  const std::string text = known_names("dnacer97", dancers);
  EXPECT_NE(text.find("did you mean \"dancer97\"?"), std::string::npos) << text;
  EXPECT_NE(text.find("dancer49, ..."), std::string::npos) << text;
  EXPECT_EQ(text.find("dancer50"), std::string::npos) << text;
}

}  // namespace
}  // namespace mocaplm::suggest_test
