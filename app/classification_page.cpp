#include "app/classification_page.h"

#include <set>

#include "common/settings.h"
#include "common/text.h"
#include "motion/dataset.h"
#include "viewer/chart.h"

namespace mocaplm {

namespace {

// Figures on the stage, and rows of the table of mistakes a label.
constexpr std::size_t kFigures = 6, kMistakes = 100;

std::string percent(double share) {
  return format_fixed(100 * share, 1) + " %";
}

std::size_t at(Eigen::Index i) {
  return static_cast<std::size_t>(i);
}

PagePlot accuracies(const ClassifyResult& result) {
  BarChart chart{"Clips whose label is found", {}, {}};
  std::vector<std::string> columns = {"label"};
  for (const MethodScores& method : result.methods) {
    chart.methods.push_back(method.method);
    columns.push_back(method.method);
  }
  columns.emplace_back("clips");
  Table table("Accuracy of clips", columns);
  for (std::size_t k = 0; k < result.tasks.size(); ++k) {
    BarChart::Row row{result.tasks[k].label, {}, ""};
    std::vector<Json> cells = {row.name};
    for (const MethodScores& method : result.methods) {
      row.percent.push_back(100 * method.tasks[k].clip_accuracy);
      cells.emplace_back(percent(method.tasks[k].clip_accuracy));
    }
    const std::int64_t clips = result.methods.back().tasks[k].clips;
    row.note = std::to_string(clips) + " clips";
    cells.emplace_back(clips);
    chart.rows.push_back(row);
    table.row(cells);
  }
  table.note("windows of " + std::to_string(result.window_frames) + " frames at " +
             format_number(result.fps) + " per second; a clip's class is the likeliest over its " +
             "windows");
  return {bars_svg(chart), table};
}

PagePlot matrix(const Task& task, const MethodScores& method, const TaskScore& score) {
  MatrixChart chart{task.label + ": what is taken for what", task.values, {}};
  Table table("Taken for another, " + task.label, {"true", "taken for", "clips"});
  for (Eigen::Index r = 0; r < score.confusion.rows(); ++r) {
    chart.counts.emplace_back();
    for (Eigen::Index c = 0; c < score.confusion.cols(); ++c) {
      const int count = score.confusion(r, c);
      chart.counts.back().push_back(count);
      if (r != c && count > 0) table.row({task.values[at(r)], task.values[at(c)], count});
    }
  }
  if (table.rows().empty()) table.note("no clip is taken for another class");
  table.note(method.method + ", " + std::to_string(score.clips) + " clips");
  return {matrix_svg(chart), table};
}

// The share of each class's clips that each method finds.
PagePlot classes(const Task& task, std::size_t k, const ClassifyResult& result) {
  BarChart chart{task.label + ": clips of each class that are found", {}, {}};
  std::vector<std::string> columns = {"class"};
  for (const MethodScores& method : result.methods) {
    chart.methods.push_back(method.method);
    columns.push_back(method.method);
  }
  columns.emplace_back("clips");
  Table table("Found, " + task.label, columns);
  for (std::size_t c = 0; c < task.values.size(); ++c) {
    const auto index = static_cast<Eigen::Index>(c);
    const int clips = result.methods.back().tasks[k].confusion.row(index).sum();
    if (clips == 0) continue;
    BarChart::Row row{task.values[c], {}, std::to_string(clips) + " clips"};
    std::vector<Json> cells = {row.name};
    for (const MethodScores& method : result.methods) {
      const double share = static_cast<double>(method.tasks[k].confusion(index, index)) / clips;
      row.percent.push_back(100 * share);
      cells.emplace_back(percent(share));
    }
    cells.emplace_back(clips);
    chart.rows.push_back(row);
    table.row(cells);
  }
  return {bars_svg(chart), table};
}

// Tells of a clip, for each label that it gets wrong, what it is and what it is taken for.
std::string mistake_text(const Task& task, const Mistake& mistake) {
  return task.label + ": " + task.values[at(mistake.truth)] + ", taken for " +
         task.values[at(mistake.predicted)];
}

Table mistakes_table(const ClassifyResult& result) {
  Table table("Clips that it gets wrong", {"clip", "label", "true", "taken for"});
  std::size_t left_out = 0;
  for (std::size_t k = 0; k < result.tasks.size(); ++k) {
    const Task& task = result.tasks[k];
    std::size_t rows = 0;
    for (const Mistake& one : result.methods.back().tasks[k].mistakes) {
      if (++rows <= kMistakes)
        table.row(
            {one.clip, task.label, task.values[at(one.truth)], task.values[at(one.predicted)]});
      else
        ++left_out;
    }
  }
  if (left_out > 0) table.note("and " + std::to_string(left_out) + " more");
  return table;
}

// A few of the mistakes, in turn of each label.
void add_figures(const ClassifyOptions& options, const ClassifyResult& result, Page& page) {
  const Dataset dataset = load_dataset(options.data);
  std::set<std::string> shown;
  for (std::size_t i = 0, before = 1; page.motions.size() < kFigures && before > 0; ++i) {
    before = 0;
    for (std::size_t k = 0; k < result.tasks.size() && page.motions.size() < kFigures; ++k) {
      const auto& mistakes = result.methods.back().tasks[k].mistakes;
      if (i >= mistakes.size()) continue;
      ++before;
      for (const DatasetEntry& entry : dataset.entries)
        if (entry.name == mistakes[i].clip && shown.insert(entry.name).second)
          page.motions.push_back({entry.name,
                                  load_clip(dataset, entry),
                                  {},
                                  {},
                                  mistake_text(result.tasks[k], mistakes[i])});
    }
  }
}

}  // namespace

Page classification_page(const ClassifyOptions& options, const ClassifyResult& result) {
  Page page;
  page.title = "What the classifier finds, and what it gets wrong";
  if (result.procedural) page.note = "procedural dances, made by formulas, not recorded";
  add_figures(options, result, page);
  page.plots.push_back(accuracies(result));
  for (std::size_t k = 0; k < result.tasks.size(); ++k) {
    const MethodScores& method = result.methods.back();
    if (method.tasks[k].clips == 0) continue;
    page.plots.push_back(matrix(result.tasks[k], method, method.tasks[k]));
    page.plots.push_back(classes(result.tasks[k], k, result));
  }
  const Table wrong = mistakes_table(result);
  if (!wrong.rows().empty()) page.tables.push_back(wrong);
  page.settings = {{"model", options.model.string()},
                   {"data", options.data.string()},
                   {"split", options.split},
                   {"time", format_duration(result.seconds)}};
  add_settings(page, settings_json(options.config));
  return page;
}

}  // namespace mocaplm
