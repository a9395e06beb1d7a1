// Accuracies of predictions made by hand.
#include "classify/scores.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mocaplm::scores_test {
namespace {

// Clips a, b of class 0, c of class 1, d without the label; two windows each, but one of c.
LabelledSplit four_clips() {
  LabelledSplit split;
  for (const auto& [name, one] : {std::pair{"a", 0}, {"b", 0}, {"c", 1}, {"d", -1}})
    split.clips.push_back({name, {}, {7, one}});  // the task looked at is the second one
  for (const std::size_t clip : {0, 0, 1, 1, 2, 3, 3}) split.windows.push_back({clip, 0});
  return split;
}

// Log-probabilities of three classes.
Eigen::MatrixXd four_predictions() {
  Eigen::MatrixXd p(7, 3);
  p << .90, .05, .05,  // a: right
      .30, .60, .10,   // a: wrong; the sum of the logs is right
      .40, .35, .25,   // b: right, but not sure
      .01, .98, .01,   // b: wrong and sure; the sum is wrong
      .10, .20, .70,   // c: wrong
      .00, 1.0, .00,   // d: has no label
      .00, 1.0, .00;
  return p.array().log().matrix();
}

TEST(ScoreTask, CountsWindowsAndClipsThatHaveTheLabel) {
  const TaskScore score = score_task(four_clips(), 1, four_predictions());
  EXPECT_EQ(score.windows, 5);
  EXPECT_EQ(score.clips, 3);
  EXPECT_DOUBLE_EQ(score.window_accuracy, 2. / 5);
  EXPECT_DOUBLE_EQ(score.clip_accuracy, 1. / 3);
  // Class 0: 2 of 4 windows, 1 of 2 clips; class 1: none; class 2 does not occur.
  EXPECT_DOUBLE_EQ(score.balanced_window_accuracy, (2. / 4 + 0) / 2);
  EXPECT_DOUBLE_EQ(score.balanced_clip_accuracy, (1. / 2 + 0) / 2);
  Eigen::MatrixXi confusion(3, 3);
  confusion << 1, 1, 0, 0, 0, 1, 0, 0, 0;
  EXPECT_EQ(score.confusion, confusion);
}

// Summed logs, not votes and not summed probabilities.
TEST(ScoreTask, AClipsClassHasTheLargestSumOfLogs) {
  LabelledSplit split;
  split.clips.push_back({"a", {}, {1}});
  split.windows = {{0, 0}, {0, 5}, {0, 10}};
  Eigen::MatrixXd p(3, 2);
  p << .6, .4, .6, .4, .01, .99;  // two of three votes for class 0
  EXPECT_EQ(score_task(split, 0, p.array().log().matrix()).clip_accuracy, 1);
  p << .98, .02, .98, .02, 1e-9, 1 - 1e-9;  // 1.96 of 3 for class 0
  EXPECT_EQ(score_task(split, 0, p.array().log().matrix()).clip_accuracy, 1);
}

TEST(ScoreTask, AConstantARowChangesNothing) {
  Eigen::MatrixXd logs = four_predictions();
  for (Eigen::Index w = 0; w < logs.rows(); ++w)
    logs.row(w).array() += 10. * static_cast<double>(w) - 30;
  const TaskScore one = score_task(four_clips(), 1, four_predictions()),
                  other = score_task(four_clips(), 1, logs);
  EXPECT_EQ(one.confusion, other.confusion);
  EXPECT_EQ(one.window_accuracy, other.window_accuracy);
}

TEST(ScoreTask, NothingLabelledIsNoDivisionByZero) {
  LabelledSplit split;
  split.clips.push_back({"a", {}, {-1}});
  split.windows = {{0, 0}};
  const TaskScore score = score_task(split, 0, Eigen::MatrixXd::Zero(1, 2));
  EXPECT_EQ(score.windows, 0);
  EXPECT_EQ(score.window_accuracy, 0);
  EXPECT_EQ(score.balanced_clip_accuracy, 0);
}

TEST(Tables, ShowPercentAndClassNames) {
  const std::vector<Task> tasks = {{"other", {"x", "y"}}, {"genre", {"hip", "hop", "jazz"}}};
  const TaskScore score = score_task(four_clips(), 1, four_predictions());
  const MethodScores method{"By hand", {score, score}};
  const std::string table =
      accuracy_table("Windows", tasks, {method}, &TaskScore::window_accuracy).text();
  for (const char* part : {"Windows", "genre", "By hand", "40.0"})
    EXPECT_NE(table.find(part), std::string::npos) << part << "\n" << table;
  const std::string confusion = confusion_table(tasks[1], method, 1).text();
  for (const char* part : {"genre", "hip", "hop", "jazz", "By hand"})
    EXPECT_NE(confusion.find(part), std::string::npos) << part << "\n" << confusion;
}

}  // namespace
}  // namespace mocaplm::scores_test
