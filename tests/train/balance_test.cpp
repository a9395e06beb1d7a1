#include "train/balance.h"

#include <gtest/gtest.h>

#include <map>

namespace mocaplm::balance_test {
namespace {

// Two clips of 100 and 300 tokens are "large", one of 100 is "small", one of 50 has no label.
Corpus unequal() {
  Corpus corpus;
  const auto add = [&](std::size_t tokens, const Labels& values) {
    EncodedClip clip;
    clip.ids.resize(tokens);
    clip.values = values;
    corpus.clips.push_back(clip);
  };
  add(100, {{"set", "large"}});
  add(300, {{"set", "large"}, {"genre", "waltz"}});
  add(100, {{"set", "small"}});
  add(50, {});
  return corpus;
}

std::vector<double> chances(const Corpus& corpus) {
  double sum = 0;
  std::vector<double> chance;
  for (const EncodedClip& clip : corpus.clips)
    sum += chance.emplace_back(clip.weight * static_cast<double>(clip.ids.size()));
  for (double& one : chance) one /= sum;
  return chance;
}

TEST(Balance, NothingChangesForAShareOfZero) {
  Corpus corpus = unequal();
  balance(corpus, "set", 0);
  const std::vector<double> chance = chances(corpus);
  const double tokens[] = {100, 300, 100, 50};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(chance[i], tokens[i] / 550, 1e-12);
}

TEST(Balance, AllValuesAreDrawnAlikeForAShareOfOne) {
  Corpus corpus = unequal();
  balance(corpus, "set", 1);
  const std::vector<double> chance = chances(corpus);
  EXPECT_NEAR(chance[0] + chance[1], 1 / 3.0, 1e-12);
  EXPECT_NEAR(chance[1], 3 * chance[0], 1e-12) << "within a value by length";
  EXPECT_NEAR(chance[2], 1 / 3.0, 1e-12);
  EXPECT_NEAR(chance[3], 1 / 3.0, 1e-12) << "no label is a value, too";
}

TEST(Balance, HalfWayGoesWithTheRoots) {
  Corpus corpus = unequal();
  balance(corpus, "set", 0.5);
  const std::vector<double> chance = chances(corpus);
  EXPECT_NEAR((chance[0] + chance[1]) / chance[2], 2, 1e-12);  // the root of 400 / 100
}

}  // namespace
}  // namespace mocaplm::balance_test
