// The tables of experiments, from rows whose numbers are known.
#include "experiments/report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/refusal.h"

namespace mocaplm::report_test {
namespace {

// `joints` with bits 1, 2, 3, ... over the channels, 3 of the root, and a separator of half a bit.
RowResult row(const std::string& line, const std::string& column, std::vector<int> joints,
              double fps = 20) {
  RowResult r;
  r.name = line + ", " + column;
  r.line = line;
  r.column = column;
  r.fps = fps;
  r.bins = 360;
  r.binning = "uniform";
  r.joints = std::move(joints);
  for (std::size_t c = 0; c < 3 * r.joints.size() + 3; ++c) {
    r.bits.push_back(static_cast<double>(c + 1));
    r.order_2.push_back(10 * static_cast<double>(c + 1));
  }
  r.bits.push_back(0.5);
  r.predicted = static_cast<std::int64_t>(r.bits.size());
  r.parameters = 77;
  r.steps = 5;
  r.minutes = 2;
  return r;
}

TEST(ExperimentReport, BitsAreCountedOverTheSameChannels) {
  const std::vector<RowResult> rows = {row("a", "", {0, 4, 5}), row("b", "", {4, 5, 6})};
  EXPECT_EQ(shared_joints(rows), (std::vector<int>{4, 5}));
  // Channels 3..8 of the first row, 0..5 of the second.
  EXPECT_DOUBLE_EQ(bits_over(rows[0], rows[0].bits, {4, 5}), 4 + 5 + 6 + 7 + 8 + 9);
  EXPECT_DOUBLE_EQ(bits_over(rows[1], rows[1].bits, {4, 5}), 1 + 2 + 3 + 4 + 5 + 6);
  EXPECT_DOUBLE_EQ(mean_loss(rows[0]), (78 + 0.5) * std::log(2.0) / 13);
}

TEST(ExperimentReport, TakesTheThesissForm) {
  const std::vector<RowResult> rows = {
      row("Absolute", "Causal", {1}), row("Absolute", "Masked", {1}), row("Custom", "Causal", {1})};
  const std::vector<Table> tables = experiment_tables("Table 4.4", rows, "test");
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[0].columns(), (std::vector<std::string>{"", "Causal bits/frame", "Causal loss",
                                                           "Masked bits/frame", "Masked loss"}));
  ASSERT_EQ(tables[0].rows().size(), 2u);
  EXPECT_EQ(tables[0].rows()[0][0], "Absolute");
  EXPECT_EQ(tables[0].rows()[0][3], 6.0);
  EXPECT_TRUE(tables[0].rows()[1][3].is_null());
  ASSERT_EQ(tables[1].rows().size(), 3u);
  EXPECT_EQ(tables[1].rows()[0][1], 6.0);
  EXPECT_EQ(tables[1].rows()[0][2], 60.0);
  EXPECT_EQ(tables[1].rows()[0][3], 21.0);  // the root as well, not the separator
}

TEST(ExperimentReport, SaysWhatDoesNotCompare) {
  std::vector<RowResult> rows = {row("a", "", {1}), row("b", "", {1}, 60)};
  const Table rates = experiment_tables("t", rows, "test")[0];
  EXPECT_EQ(rates.columns(), (std::vector<std::string>{"", "bits/frame", "bits/s", "loss"}));
  EXPECT_EQ(rates.rows()[1][2], 360.0);
  EXPECT_TRUE(contains(rates.text(), "compare bits/s"));
  EXPECT_FALSE(contains(rates.text(), "masked"));
  rows[1].masked = true;
  rows[1].bins = 90;
  const std::string text = experiment_tables("t", rows, "test")[0].text();
  EXPECT_TRUE(contains(text, "a masked model sees"));
  EXPECT_TRUE(contains(text, "the bins differ"));
}

TEST(ExperimentReport, ListsAccuracies) {
  RowResult one = row("Our model", "", {1});
  one.accuracy = {{"Majority class", {{"genre", 0.1}, {"dancer", 0.05}}},
                  {"LDA", {{"genre", 0.5}, {"dancer", 0.25}}},
                  {"Transformer", {{"genre", 0.9}, {"dancer", 0.75}}}};
  RowResult two = one;
  two.name = "Their model";
  two.accuracy.back().labels[0].second = 0.8;
  const std::vector<Table> tables = experiment_tables("Table 4.8", {one, two}, "test");
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0].columns(), (std::vector<std::string>{"Method", "genre", "dancer"}));
  ASSERT_EQ(tables[0].rows().size(), 4u);  // the baselines once
  EXPECT_EQ(tables[0].rows()[3][0], "Their model");
  EXPECT_EQ(tables[0].rows()[3][1], 80.0);
}

TEST(ExperimentReport, ResultsAreKeptAsJson) {
  RowResult one = row("a", "c", {1, 5});
  const Json json = to_json(one);
  EXPECT_EQ(to_json(result_from_json(json, "x")), json);
  one.accuracy = {{"LDA", {{"genre", 0.5}}}};
  EXPECT_EQ(to_json(result_from_json(to_json(one), "x")), to_json(one));
  Json broken = json;
  broken["bits_of_a_frame"].erase(0);
  EXPECT_TRUE(
      contains(refusal<DataError>([&] { result_from_json(broken, "file.json"); }), "file.json"));
}

}  // namespace
}  // namespace mocaplm::report_test
