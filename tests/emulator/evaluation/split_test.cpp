#include "emulator/evaluation/split.h"

#include <gtest/gtest.h>

#include <set>

#include "support/refusal.h"

namespace mocaplm::split_test {
namespace {

std::vector<DatasetEntry> entries(int clips, int groups) {
  std::vector<DatasetEntry> all;
  for (int i = 0; i < clips; ++i) {
    DatasetEntry entry;
    entry.name = "clip" + std::to_string(100 + i);
    entry.group = "group" + std::to_string(i % groups);
    all.push_back(entry);
  }
  return all;
}

std::set<std::string> names(const std::vector<DatasetEntry>& list, bool groups) {
  std::set<std::string> all;
  for (const DatasetEntry& entry : list) all.insert(groups ? entry.group : entry.name);
  return all;
}

TEST(SplitClips, KeepsGroupsTogetherAndEveryClipOnce) {
  const std::vector<DatasetEntry> all = entries(60, 20);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ClipSplit split = split_clips(all, 0.4, seed, "walk");
    EXPECT_EQ(split.fit.size() + split.test.size(), 60u);
    EXPECT_NEAR(double(split.test.size()), 24, 3);
    for (const std::string& group : names(split.fit, true))
      EXPECT_EQ(names(split.test, true).count(group), 0u);
  }
}

TEST(SplitClips, RepeatsAndDiffersBySeed) {
  const std::vector<DatasetEntry> all = entries(30, 30);
  const auto test = [&](std::uint64_t seed) {
    return names(split_clips(all, 0.3, seed, "walk").test, false);
  };
  EXPECT_EQ(test(1), test(1));
  EXPECT_NE(test(1), test(2));
  EXPECT_EQ(test(1).size(), 9u);
}

TEST(SplitClips, RefusesTooFewClips) {
  const auto message = [](int clips, int groups) {
    return refusal([&] { split_clips(entries(clips, groups), 0.4, 1, "walk of data"); });
  };
  EXPECT_TRUE(contains(message(1, 1), "walk of data: has 1 clip, expected 5 or more"));
  EXPECT_TRUE(contains(message(4, 4), "has 4 clips"));
  EXPECT_TRUE(contains(message(9, 1), "its 9 clips are of 1 group"));
  EXPECT_NO_THROW(split_clips(entries(5, 5), 0.99, 1, "walk"));
  EXPECT_NO_THROW(split_clips(entries(5, 5), 0.01, 1, "walk"));
  EXPECT_NO_THROW(split_clips(entries(10, 2), 0.4, 1, "walk"));
}

}  // namespace
}  // namespace mocaplm::split_test
