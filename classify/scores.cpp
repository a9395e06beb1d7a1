#include "classify/scores.h"

#include <map>

namespace mocaplm {

namespace {

// Counts right answers, per class too.
class Tally {
 public:
  explicit Tally(int classes) : right_(static_cast<std::size_t>(classes)), all_(right_.size()) {}
  void add(int truth, int predicted) {
    ++all_[static_cast<std::size_t>(truth)];
    right_[static_cast<std::size_t>(truth)] += truth == predicted ? 1 : 0;
  }
  std::int64_t count() const {
    std::int64_t sum = 0;
    for (const std::int64_t n : all_) sum += n;
    return sum;
  }
  double accuracy() const {
    std::int64_t sum = 0;
    for (const std::int64_t n : right_) sum += n;
    return count() == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(count());
  }
  double balanced() const {
    double sum = 0;
    int classes = 0;
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (all_[k] > 0) {
        sum += static_cast<double>(right_[k]) / static_cast<double>(all_[k]);
        ++classes;
      }
    return classes == 0 ? 0 : sum / classes;
  }

 private:
  std::vector<std::int64_t> right_, all_;
};

int best_class(const Eigen::RowVectorXd& scores) {
  Eigen::Index best = 0;
  scores.maxCoeff(&best);
  return static_cast<int>(best);
}

}  // namespace

TaskScore score_task(const LabelledSplit& split, std::size_t task,
                     const Eigen::MatrixXd& log_scores) {
  const int classes = static_cast<int>(log_scores.cols());
  TaskScore score;
  score.confusion = Eigen::MatrixXi::Zero(classes, classes);
  Tally windows(classes), clips(classes);
  std::map<std::size_t, Eigen::RowVectorXd> sums;
  for (std::size_t w = 0; w < split.windows.size(); ++w) {
    const std::size_t clip = split.windows[w].clip;
    const int truth = split.clips[clip].classes[task];
    if (truth < 0) continue;
    const Eigen::RowVectorXd row = log_scores.row(static_cast<Eigen::Index>(w));
    windows.add(truth, best_class(row));
    const auto [sum, fresh] = sums.try_emplace(clip, row);
    if (!fresh) sum->second += row;
  }
  for (const auto& [clip, sum] : sums) {
    const int truth = split.clips[clip].classes[task], predicted = best_class(sum);
    clips.add(truth, predicted);
    ++score.confusion(truth, predicted);
    if (truth != predicted) score.mistakes.push_back({split.clips[clip].name, truth, predicted});
  }
  score.window_accuracy = windows.accuracy();
  score.balanced_window_accuracy = windows.balanced();
  score.clip_accuracy = clips.accuracy();
  score.balanced_clip_accuracy = clips.balanced();
  score.windows = windows.count();
  score.clips = clips.count();
  return score;
}

Table accuracy_table(const std::string& title, const std::vector<Task>& tasks,
                     const std::vector<MethodScores>& methods, double TaskScore::*measure) {
  std::vector<std::string> columns = {"Method"};
  for (const Task& task : tasks) columns.push_back(task.label);
  Table table(title, columns);
  table.digits(std::vector<int>(columns.size(), 1));
  for (const MethodScores& method : methods) {
    std::vector<Json> cells = {method.method};
    for (const TaskScore& score : method.tasks) cells.push_back(100 * (score.*measure));
    table.row(cells);
  }
  return table;
}

Table confusion_table(const Task& task, const MethodScores& method, std::size_t index) {
  std::vector<std::string> columns = {"true \\ predicted"};
  columns.insert(columns.end(), task.values.begin(), task.values.end());
  Table table(task.label + ", clips, " + method.method, columns);
  const Eigen::MatrixXi& confusion = method.tasks[index].confusion;
  for (std::size_t k = 0; k < task.values.size(); ++k) {
    std::vector<Json> cells = {task.values[k]};
    for (Eigen::Index j = 0; j < confusion.cols(); ++j)
      cells.push_back(confusion(static_cast<Eigen::Index>(k), j));
    table.row(cells);
  }
  return table;
}

}  // namespace mocaplm
