#include "motion/chosen_clips.h"

#include <gtest/gtest.h>

#include "support/refusal.h"

namespace mocaplm::chosen_clips_test {
namespace {

// a and b walk, c and d run; d has no style; a is of the test split.
Dataset example() {
  Dataset dataset;
  dataset.directory = "ds";
  for (const char* name : {"a", "b", "c", "d"}) {
    DatasetEntry entry;
    entry.name = name;
    entry.labels = {{"content", name[0] < 'c' ? "walk" : "run"}};
    if (name[0] != 'd') entry.labels["style"] = "happy";
    entry.split = name[0] == 'a' ? "test" : "train";
    dataset.entries.push_back(entry);
  }
  return dataset;
}

std::string names(const std::vector<DatasetEntry>& entries) {
  std::string all;
  for (const DatasetEntry& entry : entries) all += entry.name;
  return all;
}

TEST(ChosenClips, HaveTheSplitAndTheLabels) {
  const Dataset dataset = example();
  EXPECT_EQ(names(chosen_entries(dataset, "", {})), "abcd");
  EXPECT_EQ(names(chosen_entries(dataset, "train", {})), "bcd");
  EXPECT_EQ(names(chosen_entries(dataset, "", {"content=walk"})), "ab");
  EXPECT_EQ(names(chosen_entries(dataset, "test", {"content=walk"})), "a");
  EXPECT_EQ(names(chosen_entries(dataset, "", {"content=run", "style=happy"})), "c");
}

TEST(ChosenClips, SayWhatIsNotThere) {
  const Dataset dataset = example();
  const auto usage = [&](const std::string& where) {
    return refusal<UsageError>([&] { chosen_entries(dataset, "", {where}); });
  };
  for (const char* text : {"content", "=walk", "content=", "="})
    EXPECT_EQ(usage(text), std::string("--where ") + text + ": expected label=value");
  EXPECT_EQ(usage("contents=walk"),
            "--where contents=walk: ds has no label \"contents\", did you mean \"content\"? "
            "Its labels: content, style");
  EXPECT_EQ(usage("content=wlak"),
            "--where content=wlak: no clip of ds has the content \"wlak\", did you mean \"walk\"? "
            "Its values: run, walk");
}

TEST(ChosenClips, NoneLeftIsTheDatasFault) {
  const Dataset dataset = example();
  EXPECT_EQ(refusal([&] {
              chosen_entries(dataset, "test", {"content=run", "style=happy"});
            }),
            "ds: has no clip in split \"test\" with content=run, style=happy");
  EXPECT_EQ(refusal([&] { chosen_entries(dataset, "validation", {}); }),
            "ds: has no clip in split \"validation\"");
  EXPECT_EQ(refusal([&] {
              chosen_entries(dataset, "", {"content=run", "content=walk"});
            }),
            "ds: has no clip with content=run, content=walk");
  Dataset empty;
  empty.directory = "ds";
  EXPECT_EQ(refusal([&] { chosen_entries(empty, "", {}); }), "ds: has no clip");
}

TEST(ChosenClips, ValuesMayHoldTheSign) {
  EXPECT_EQ(parse_where("music=a=b"), (std::pair<std::string, std::string>{"music", "a=b"}));
}

TEST(ChosenClips, LabelsAreCheckedForWhoeverAsks) {
  const Dataset dataset = example();
  EXPECT_NO_THROW(check_label(dataset, "style", "--by"));
  EXPECT_NO_THROW(check_label_value(dataset, "style", "happy", "--values"));
  EXPECT_EQ(refusal<UsageError>([&] { check_label(dataset, "dancer", "--by"); }),
            "--by: ds has no label \"dancer\". Its labels: content, style");
}

}  // namespace
}  // namespace mocaplm::chosen_clips_test
