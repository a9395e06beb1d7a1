#include "motion/import/splits.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"

namespace mocaplm::splits_test {
namespace {

// `groups` groups of `size` clips of one second.
std::vector<DatasetEntry> entries_of(int groups, int size, const std::string& genre = "x") {
  std::vector<DatasetEntry> all;
  for (int g = 0; g < groups; ++g)
    for (int i = 0; i < size; ++i) {
      DatasetEntry entry;
      entry.name = genre + std::to_string(g) + "_" + std::to_string(i);
      entry.group = genre + std::to_string(g);
      entry.frames = 30;
      entry.fps = 30;
      entry.labels["genre"] = genre;
      all.push_back(entry);
    }
  return all;
}

std::map<std::string, int> count(const std::vector<DatasetEntry>& entries) {
  std::map<std::string, int> counts;
  for (const DatasetEntry& entry : entries) ++counts[entry.split];
  return counts;
}

TEST(Splits, SharesAreMetAndGroupsStayTogether) {
  auto entries = entries_of(100, 2);
  assign_splits(entries, {0.8, 0.1, 0.1}, {}, 1);
  EXPECT_EQ(count(entries),
            (std::map<std::string, int>{{"test", 20}, {"train", 160}, {"validation", 20}}));
  std::map<std::string, std::set<std::string>> of_group;
  for (const auto& entry : entries) of_group[entry.group].insert(entry.split);
  for (const auto& [group, splits] : of_group) EXPECT_EQ(splits.size(), 1u);
}

TEST(Splits, SmallSetsStillFillEverySplit) {
  for (int groups = 3; groups < 12; ++groups) {
    auto entries = entries_of(groups, 1);
    assign_splits(entries, {0.8, 0.1, 0.1}, {}, 7);
    EXPECT_EQ(count(entries).size(), 3u) << groups;
  }
  auto one = entries_of(1, 3);
  assign_splits(one, {0.8, 0.1, 0.1}, {}, 7);
  EXPECT_EQ(one[0].split, "train");
}

TEST(Splits, SameSeedSameSplitsInAnyOrder) {
  auto entries = entries_of(40, 1);
  auto reversed = std::vector<DatasetEntry>(entries.rbegin(), entries.rend());
  auto other = entries;
  assign_splits(entries, {0.6, 0.2, 0.2}, {}, 3);
  assign_splits(reversed, {0.6, 0.2, 0.2}, {}, 3);
  assign_splits(other, {0.6, 0.2, 0.2}, {}, 4);
  bool differs = false;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_EQ(entries[i].split, reversed[entries.size() - 1 - i].split);
    differs = differs || entries[i].split != other[i].split;
  }
  EXPECT_TRUE(differs);
}

TEST(Splits, EveryStratumGetsItsShare) {
  auto entries = entries_of(50, 1, "waack");
  const auto few = entries_of(5, 1, "krump");
  entries.insert(entries.end(), few.begin(), few.end());
  assign_splits(entries, {0.8, 0.1, 0.1}, {"genre"}, 1);
  std::vector<DatasetEntry> krump(entries.begin() + 50, entries.end());
  EXPECT_EQ(count(krump),
            (std::map<std::string, int>{{"test", 1}, {"train", 3}, {"validation", 1}}));
}

TEST(Splits, AShareOfZeroStaysEmptyAndDecidedClipsStay) {
  auto entries = entries_of(10, 2);
  entries[0].split = "test";  // pulls its group
  assign_splits(entries, {0.9, 0.1, 0}, {}, 1);
  EXPECT_EQ(entries[1].split, "test");
  EXPECT_EQ(count(entries)["test"], 2);
  entries[1].split = "train";
  EXPECT_THROW(assign_splits(entries, {0.9, 0.1, 0}, {}, 1), DataError);
}

TEST(Splits, SharesAreChecked) {
  EXPECT_EQ(parse_shares("0.7,0.2,0.1")[1], 0.2);
  EXPECT_EQ(parse_shares("1,0,0")[0], 1);
  for (const char* bad :
       {"", "1", "0.5,0.5", "0.5,0.5,0.5", "-0.1,1,0.1", "nan,0,1", "0.8,0.1,0.1x", "a,b,c"})
    EXPECT_THROW(parse_shares(bad), UsageError) << bad;
}

TEST(Splits, ListsNameClipsBySuffixOrName) {
  const TemporaryFolder folder;
  std::vector<SourceFile> sources;
  std::vector<DatasetEntry> entries;
  for (const char* path : {"/x/salsa/01.bvh", "/x/salsa/02.bvh", "/x/indian/02.bvh"}) {
    SourceFile source{path, "", ""};
    source.name = source.folder() + "_" + source.path.stem().string();
    DatasetEntry entry;
    entry.name = source.name;
    sources.push_back(source);
    entries.push_back(entry);
  }
  write_file(folder / "test.txt", "salsa/01\r\n\nindian_02\n");
  const Shares left = use_split_lists({"test=" + (folder / "test.txt").string()}, sources,
                                      {0.8, 0.1, 0.1}, entries);
  EXPECT_EQ(entries[0].split, "test");
  EXPECT_EQ(entries[1].split, "");
  EXPECT_EQ(entries[2].split, "test");
  EXPECT_NEAR(left[0], 8.0 / 9, 1e-12);
  EXPECT_EQ(left[2], 0);

  write_file(folder / "bad.txt", "salsa/01\nsalsa/07\n");
  const std::string bad = (folder / "bad.txt").string();
  EXPECT_THROW(use_split_lists({"train=" + bad}, sources, left, entries), DataError);
  for (auto& entry : entries) entry.split.clear();
  try {
    use_split_lists({"train=" + bad}, sources, left, entries);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("line 2"), std::string::npos) << error.what();
  }
  EXPECT_THROW(use_split_lists({"tset=" + bad}, sources, left, entries), UsageError);
  EXPECT_THROW(use_split_lists({bad}, sources, left, entries), UsageError);
  EXPECT_THROW(use_split_lists({"test=" + bad + ".none"}, sources, left, entries), DataError);
}

}  // namespace
}  // namespace mocaplm::splits_test
