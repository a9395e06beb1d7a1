// emulate test from the command line: tables, report, exit codes, messages.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "support/small_dataset.h"

namespace fs = std::filesystem;

namespace mocaplm::emulate_test_command_test {
namespace {

class EmulateTestCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<SmallClip> clips;
    for (int i = 0; i < 7; ++i)
      clips.push_back(
          {"clip" + std::to_string(i), "train", 12 + i, {{"content", i < 6 ? "walk" : "jump"}}});
    write_dataset(folder_ / "data", clips);
  }
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
  std::string with(const std::string& options) const {
    return "emulate test " + at("data") +
           " --label content --align none --frames 10 --d1 3 --d2 2 --samples 6 "
           "--permutations 29 --postures 40 --window 4 --step 2 --level-one 0 "
           "--scheme SIEM/SequentialPCA/IG,PWI " +
           options;
  }
  Ran test(const std::string& options) const { return run_mocaplm(with(options)); }
  void expect(const std::string& options, int code, const std::string& part) const {
    expect_run(with(options), code, part);
  }
  TemporaryFolder folder_;
};

TEST_F(EmulateTestCommand, WritesTablesAndReport) {
  const Ran ran = test("--json " + at("t.json") + " --out " + at("report"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  for (const char* part : {"Table 1", "Table 2", "Table 4", "Table 5", "left out: jump"})
    EXPECT_NE(ran.text.find(part), std::string::npos) << part << "\n" << ran.text;
  EXPECT_EQ(ran.text.find("Table 3"), std::string::npos);
  const Json tables = load_json(folder_ / "t.json");
  ASSERT_GE(tables.size(), 6u);
  EXPECT_EQ(tables.at(1).at("rows").at(0).at("content"), "walk");
  EXPECT_NE(read_file(folder_ / "report/report.html").find("</svg>"), std::string::npos);
  EXPECT_EQ(load_json(folder_ / "report/settings.json").at("permutations"), 29);
}

TEST_F(EmulateTestCommand, WhatCannotBeIsRefused) {
  expect("--values jump", 3, "has 1 clip, expected 5 or more");
  expect("--values wlak", 2, "did you mean \"walk\"");
  expect("--where content=run", 2, "run");
  expect("--parts 10", 2, "expected two shares");
  expect("--samples 1", 2, "samples");
  expect("--alpha 3", 2, "alpha");
  expect("--test-share 1", 2, "test-share");
  expect("--json /proc/none/t.json", 3, "/proc/none");
  const Ran none = run_mocaplm("emulate test " + at("nowhere"));
  EXPECT_EQ(none.code, 3) << none.text;
}

// Clips of one frame and of one motion again and again.
TEST_F(EmulateTestCommand, ClipsWithoutMotionOrVariationAreNamed) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 12; ++i) {
    const bool same = i >= 6;
    clips.push_back({"c" + std::to_string(10 + i),
                     "train",
                     12,
                     {{"content", same ? "same" : "walk"}},
                     20,
                     same ? 5u : 0u});
  }
  write_dataset(folder_ / "same", clips);
  const std::string test = "emulate test " + at("same") +
                           " --label content --align none --frames 8 --level-one 0 --postures 40 "
                           "--permutations 29 --window 4 --step 2 --scheme SIEM/SequentialPCA/MVG ";
  const Ran all = run_mocaplm(test);
  EXPECT_EQ(all.code, 0) << all.text;
  EXPECT_NE(all.text.find("left out: same of "), std::string::npos) << all.text;
  const Ran one = run_mocaplm(test + "--values same");
  EXPECT_EQ(one.code, 3) << one.text;
  EXPECT_NE(one.text.find("there is no variation to emulate"), std::string::npos) << one.text;
  clips[3].frames = 1;
  write_dataset(folder_ / "same", clips);
  const Ran still = run_mocaplm(test);
  EXPECT_EQ(still.code, 3) << still.text;
  EXPECT_NE(still.text.find("c13.npz: has one frame"), std::string::npos) << still.text;
}

// A dataset none of whose classes has enough clips.
TEST_F(EmulateTestCommand, NothingToSplitIsSaid) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 4; ++i)
    clips.push_back({"c" + std::to_string(i), "train", 12, {{"content", "a" + std::to_string(i)}}});
  write_dataset(folder_ / "few", clips);
  const Ran ran = run_mocaplm("emulate test " + at("few") + " --label content");
  EXPECT_EQ(ran.code, 3) << ran.text;
  EXPECT_NE(ran.text.find("no value of content has the 5 clips"), std::string::npos) << ran.text;
}

}  // namespace
}  // namespace mocaplm::emulate_test_command_test
