#include "emulator/evaluation/evaluation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "emulator/evaluation/plots.h"
#include "emulator/evaluation/random_postures.h"
#include "emulator/evaluation/tables.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::evaluation_test {
namespace {

EvaluationOptions quick(const std::filesystem::path& data) {
  EvaluationOptions options;
  options.data = data;
  options.label = "content";
  options.scheme = {"SIEM/SequentialPCA/MVG", "PWI"};
  options.samples = 8;
  options.permutations = 49;
  options.postures = 60;
  options.window = 4;
  options.step = 2;
  options.level_one = 12;
  options.level_two = 4;
  options.threads = 2;
  options.landmarks.frames = 12;
  options.align.align = "none";
  options.options.d1 = 3;
  options.options.d2 = 2;
  return options;
}

// walk: 8 clips; run: 6; jump: 1.
Dataset small_dataset(const std::filesystem::path& folder) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 15; ++i)
    clips.push_back({"clip" + std::to_string(10 + i),
                     "train",
                     10 + i,
                     {{"content", i < 8    ? "walk"
                                  : i < 14 ? "run"
                                           : "jump"},
                      {"style", "old"}}});
  return write_dataset(folder, clips);
}

TEST(Evaluation, TestsEveryClassAndSaysWhatItLeavesOut) {
  const TemporaryFolder folder;
  small_dataset(folder / "data");
  EvaluationOptions options = quick(folder / "data");
  options.splits = 2;
  options.parts = {"0-100", "50-100"};
  const Evaluation evaluation = evaluate_emulation(options, true);
  ASSERT_EQ(evaluation.classes.size(), 4u);
  EXPECT_EQ(evaluation.classes[0].name, "run");
  EXPECT_EQ(evaluation.classes[1].name, "run 50-100 %");
  EXPECT_EQ(evaluation.classes[2].frames, 12);
  EXPECT_EQ(evaluation.classes[3].frames, 6);
  EXPECT_EQ(evaluation.classes[2].fit, 5u);
  EXPECT_EQ(evaluation.classes[2].test, 3u);
  ASSERT_EQ(evaluation.left_out.size(), 1u);
  EXPECT_EQ(evaluation.left_out[0].first, "jump");
  for (const ClassReport& one : evaluation.classes) {
    ASSERT_EQ(one.schemes.size(), 2u);
    ASSERT_EQ(one.splits.size(), 2u);
    ASSERT_EQ(one.splits[1].size(), 3u);
    EXPECT_EQ(one.two_level.size(), 6u);
    EXPECT_EQ(one.original.transitions, 0);
  }

  const std::vector<Table> tables = evaluation_tables(evaluation);
  std::string text;
  for (const Table& table : tables) text += table.text();
  for (const char* part : {"Table 1", "Table 2", "Table 3", "Table 4", "Table 5", "run 50-100 %",
                           "left out: jump", "How simulated motions differ", "over 2 splits"})
    EXPECT_TRUE(contains(text, part)) << part;
  write_report(folder / "report", evaluation, tables);
  const std::string page = read_file(folder / "report/report.html");
  EXPECT_TRUE(contains(page, "<svg"));
  EXPECT_TRUE(contains(page, "SIEM/SequentialPCA/MVG"));
  EXPECT_TRUE(std::filesystem::exists(folder / "report/plots/walk-steps.svg"));
  EXPECT_TRUE(std::filesystem::exists(
      folder / "report/plots/run-50-100-scaling-SIEM-SequentialPCA-MVG.svg"));
}

TEST(Evaluation, Repeats) {
  const TemporaryFolder folder;
  small_dataset(folder / "data");
  EvaluationOptions options = quick(folder / "data");
  options.level_one = 0;
  options.values = {"walk"};
  const auto text = [&] {
    std::string all;
    for (const Table& table : evaluation_tables(evaluate_emulation(options, false)))
      all += table.text();
    return all;
  };
  const std::string first = text();
  options.threads = 1;
  EXPECT_EQ(text(), first) << "the number of threads changes nothing";
  options.seed = 2;
  EXPECT_NE(text(), first);
}

TEST(Evaluation, RefusesWhatCannotBeTested) {
  const TemporaryFolder folder;
  small_dataset(folder / "data");
  const auto message = [&](auto change) {
    EvaluationOptions options = quick(folder / "data");
    change(options);
    try {
      evaluate_emulation(options, false);
    } catch (const Error& error) {
      return std::to_string(static_cast<int>(error.code())) + " " + error.what();
    }
    return std::string("no error");
  };
  const auto expect = [&](const std::string& text, const std::string& part) {
    EXPECT_TRUE(contains(text, part)) << text;
  };
  expect(message([](auto& o) { o.values = {"jump"}; }), "has 1 clip, expected 5 or more");
  expect(message([](auto& o) { o.values = {"wlak"}; }), "did you mean \"walk\"");
  expect(message([](auto& o) { o.label = "contant"; }), "did you mean \"content\"");
  expect(message([](auto& o) {
           o.label = "";
           o.values = {"walk"};
         }),
         "--values needs --label");
  expect(message([](auto& o) { o.scheme = {"SIEM/SequentialPCA/MGV"}; }), "2 ");
  expect(message([](auto& o) { o.scheme.clear(); }), "names no scheme");
  expect(message([](auto& o) { o.parts = {"60-20"}; }), "--parts 60-20");
  expect(message([](auto& o) { o.parts = {"a-b"}; }), "expected two shares");
  expect(message([](auto& o) { o.parts = {"50-51"}; }), "fewer than two");
  expect(message([](auto& o) { o.level_one = 5; }), "--level-one 5 leaves");
  expect(message([](auto& o) { o.where = {"style=young"}; }), "young");
}

TEST(Evaluation, RefusesClipsOfOneFrameByName) {
  const TemporaryFolder folder;
  std::vector<SmallClip> clips;
  for (int i = 0; i < 6; ++i)
    clips.push_back({"clip" + std::to_string(i), "train", i == 3 ? 1 : 20, {{"content", "walk"}}});
  write_dataset(folder / "data", clips);
  const std::string text = refusal([&] { evaluate_emulation(quick(folder / "data"), false); });
  EXPECT_TRUE(contains(text, "clip3.npz: has one frame, expected two or more")) << text;
}

// Clips of one group are not separated: where there is one group, there is nothing unseen.
TEST(Evaluation, LeavesOutWhatCannotBeSplit) {
  const TemporaryFolder folder;
  Dataset dataset = small_dataset(folder / "data");
  for (DatasetEntry& entry : dataset.entries)
    if (entry.labels.at("content") == "run") entry.group = "all of it";
  save_dataset(dataset);
  EvaluationOptions options = quick(folder / "data");
  options.level_one = 0;
  const Evaluation evaluation = evaluate_emulation(options, false);
  ASSERT_EQ(evaluation.classes.size(), 1u);
  ASSERT_EQ(evaluation.left_out.size(), 2u);
  EXPECT_EQ(evaluation.left_out[1].first, "run");
  EXPECT_TRUE(contains(evaluation.left_out[1].second, "1 group")) << evaluation.left_out[1].second;
  options.values = {"run"};
  EXPECT_TRUE(contains(refusal([&] { evaluate_emulation(options, false); }), "1 group"));
}

TEST(Parts, AreSharesOfTheTime) {
  Random random(1);
  const PostureSequence s = random_motion(2, 11, random);
  const PostureSequence part = part_of(s, parse_part("20-50"));
  ASSERT_EQ(part.frames(), 4);
  EXPECT_EQ((part.values - s.values.middleCols(2, 4)).norm(), 0);
  EXPECT_EQ(part_of(s, parse_part("0-100")).frames(), 11);
  EXPECT_TRUE(parse_part("0-100").whole());
}

TEST(FileStem, IsPlain) {
  EXPECT_EQ(file_stem("walk 60-80 %"), "walk-60-80");
  EXPECT_EQ(file_stem("../a b/ö"), "a-b");
  EXPECT_EQ(file_stem("%"), "plot");
}

}  // namespace
}  // namespace mocaplm::evaluation_test
