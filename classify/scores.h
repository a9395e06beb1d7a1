// How good predictions are: accuracy of windows and clips, balanced accuracy, confusion.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "classify/windows.h"
#include "common/table.h"

namespace mocaplm {

struct Mistake {
  std::string clip;
  int truth = 0, predicted = 0;  // classes
};

struct TaskScore {
  double window_accuracy = 0, clip_accuracy = 0;  // shares of 1
  double balanced_window_accuracy = 0,
         balanced_clip_accuracy = 0;    // mean over the classes that occur
  std::int64_t windows = 0, clips = 0;  // that have the label
  Eigen::MatrixXi confusion;            // (classes, classes) clips: true class, predicted class
  std::vector<Mistake> mistakes;        // clips, in the order of the split
};

// `log_scores` (windows, classes): log-probabilities up to a constant a row. A clip's class has the
// largest sum over its windows. Windows without the label are left out.
TaskScore score_task(const LabelledSplit& split, std::size_t task,
                     const Eigen::MatrixXd& log_scores);

struct MethodScores {
  std::string method;
  std::vector<TaskScore> tasks;
};

// The thesis's Table 4.8: a row a method, a column a label, percent.
Table accuracy_table(const std::string& title, const std::vector<Task>& tasks,
                     const std::vector<MethodScores>& methods, double TaskScore::*measure);
Table confusion_table(const Task& task, const MethodScores& method, std::size_t index);

}  // namespace mocaplm
