#include "spectral/evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.h"
#include "common/text.h"
#include "motion/chosen_clips.h"

namespace mocaplm {

namespace {

std::map<std::string, std::size_t> counts_of(const std::vector<std::string>& labels) {
  std::map<std::string, std::size_t> counts;
  for (const std::string& label : labels) ++counts[label];
  return counts;
}

struct LabelScore {
  double right = 0, entropy = 0, precision = 0;

  void add(const std::string& truth, const std::vector<std::string>& found) {
    right += vote(found) == truth;
    entropy += entropy_in_bans(found);
    precision += static_cast<double>(std::count(found.begin(), found.end(), truth)) /
                 static_cast<double>(found.size());
  }
};

void check(const QueryEvaluation& options, const Dataset& dataset) {
  if (options.labels.empty()) throw UsageError("--evaluate needs a label");
  for (const std::string& label : options.labels) check_label(dataset, label, "--evaluate");
  for (const std::string& metric : options.metrics) parse_measure(metric);
  for (const std::string& feature : options.features) {
    const std::vector<std::string> all = {"stft", "dct", "pca", "pose"};
    if (std::find(all.begin(), all.end(), feature) == all.end())
      throw UsageError("there is no feature \"" + feature + "\"" + known_names(feature, all));
  }
  for (const std::string* split : {&options.split, &options.against})
    if (*split != "all") {
      const auto& names = split_names();
      if (std::find(names.begin(), names.end(), *split) == names.end())
        throw UsageError("there is no split \"" + *split + "\": expected all, " +
                         join(names, ", "));
      if (dataset.split(*split).empty())
        throw DataError(in_file(dataset.directory.string()),
                        "the split \"" + *split + "\" is empty");
    }
}

// Clips of a split that have all of the labels.
Scope clips_of(const Dataset& dataset, const std::string& split,
               const std::vector<std::string>& labels) {
  Scope scope;
  for (const DatasetEntry& entry : dataset.entries) {
    bool in = split == "all" || entry.split == split;
    for (const std::string& label : labels) in = in && entry.labels.count(label) > 0;
    scope.push_back(in);
  }
  return scope;
}

// What the queries and the windows that may be found are, the same for all features.
struct Sides {
  std::vector<Eigen::Index> queries, findable;  // rows of the index
  Scope scope;
};

Sides sides_of(const SpectralIndex& index, const Dataset& dataset, const QueryEvaluation& options) {
  Sides sides;
  const Scope asking = clips_of(dataset, options.split, options.labels);
  sides.scope = clips_of(dataset, options.against, options.labels);
  for (Eigen::Index row = 0; row < index.size(); ++row) {
    const std::size_t clip = index.window(row).clip;
    if (asking[clip] != 0) sides.queries.push_back(row);
    if (sides.scope[clip] != 0) sides.findable.push_back(row);
  }
  if (sides.queries.empty() || sides.findable.empty())
    throw DataError(
        in_file(dataset.directory.string()),
        "no clip of split \"" + (sides.queries.empty() ? options.split : options.against) +
            "\" is as long as a window and has the label " + join(options.labels, " and "));
  return sides;
}

std::string label_of(const Dataset& dataset, const SpectralIndex& index, Eigen::Index row,
                     const std::string& label) {
  return dataset.entries[index.window(row).clip].labels.at(label);
}

std::vector<std::vector<Neighbour>> neighbours_of(const SpectralIndex& index,
                                                  const Dataset& dataset, const Sides& sides,
                                                  const QueryEvaluation& options,
                                                  const std::string& metric) {
  Series queries(static_cast<Eigen::Index>(sides.queries.size()), index.dimensions());
  for (std::size_t i = 0; i < sides.queries.size(); ++i)
    queries.row(static_cast<Eigen::Index>(i)) =
        index.rows().row(sides.queries[i]) * index.lengths()[sides.queries[i]];
  return nearest_of_many(
      index, queries, options.query.k, parse_measure(metric),
      [&](Eigen::Index q) {
        const Eigen::Index row = sides.queries[static_cast<std::size_t>(q)];
        return without_same(dataset, &dataset.entries[index.window(row).clip],
                            options.query.exclude_same, sides.scope);
      },
      [&](Eigen::Index q) { return sides.queries[static_cast<std::size_t>(q)]; }, options.threads);
}

// What no search would give: the most frequent label for all, neighbours drawn from all windows.
std::vector<Json> chance_cells(const SpectralIndex& index, const Dataset& dataset,
                               const Sides& sides, const QueryEvaluation& options) {
  std::vector<Json> cells = {"chance", "", nullptr};
  for (const std::string& label : options.labels) {
    std::vector<std::string> findable;
    for (const Eigen::Index row : sides.findable)
      findable.push_back(label_of(dataset, index, row, label));
    const std::map<std::string, std::size_t> counts = counts_of(findable);
    const std::string most = vote(findable);
    double right = 0, precision = 0;
    for (const Eigen::Index row : sides.queries) {
      const std::string truth = label_of(dataset, index, row, label);
      right += truth == most;
      if (const auto found = counts.find(truth); found != counts.end())
        precision += static_cast<double>(found->second) / static_cast<double>(findable.size());
    }
    const auto n = static_cast<double>(sides.queries.size());
    cells.push_back(100 * right / n);
    cells.push_back(entropy_in_bans(findable));
    cells.push_back(100 * precision / n);
  }
  return cells;
}

std::vector<Json> scored_cells(const SpectralIndex& index, const Dataset& dataset,
                               const Sides& sides, const QueryEvaluation& options,
                               const std::string& metric) {
  std::vector<LabelScore> scores(options.labels.size());
  std::int64_t answered = 0, q = 0;
  for (const auto& found : neighbours_of(index, dataset, sides, options, metric)) {
    const Eigen::Index row = sides.queries[static_cast<std::size_t>(q++)];
    if (found.empty()) continue;
    ++answered;
    for (std::size_t l = 0; l < scores.size(); ++l) {
      std::vector<std::string> labels;
      for (const Neighbour& one : found)
        labels.push_back(label_of(dataset, index, one.row, options.labels[l]));
      scores[l].add(label_of(dataset, index, row, options.labels[l]), labels);
    }
  }
  if (answered == 0)
    throw DataError(
        in_file(options.dataset.string()),
        "nothing is left to find beside the queries' own " + options.query.exclude_same + "s");
  std::vector<Json> cells = {index.config().feature, metric, index.dimensions()};
  for (const LabelScore& score : scores) {
    const auto n = static_cast<double>(answered);
    cells.insert(cells.end(),
                 {100 * score.right / n, score.entropy / n, 100 * score.precision / n});
  }
  return cells;
}

// Queries whose value of the label none of the windows has that they may find: their vote cannot be
// right.
std::size_t lone_queries(const SpectralIndex& index, const Dataset& dataset, const Sides& sides,
                         const QueryEvaluation& options, const std::string& label) {
  std::vector<std::size_t> windows(dataset.entries.size());  // of each clip, that may be found
  for (const Eigen::Index row : sides.findable) ++windows[index.window(row).clip];
  const auto lone = [&](std::size_t clip) {
    const Scope scope =
        without_same(dataset, &dataset.entries[clip], options.query.exclude_same, sides.scope);
    const std::string& truth = dataset.entries[clip].labels.at(label);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const std::size_t itself = i == clip ? 1 : 0;
      if (scope[i] != 0 && windows[i] > itself && dataset.entries[i].labels.at(label) == truth)
        return false;
    }
    return true;
  };
  std::map<std::size_t, bool> known;
  std::size_t count = 0;
  for (const Eigen::Index row : sides.queries) {
    const std::size_t clip = index.window(row).clip;
    if (known.count(clip) == 0) known[clip] = lone(clip);
    count += known[clip];
  }
  return count;
}

Table empty_table(const QueryEvaluation& options) {
  std::vector<std::string> columns = {"feature", "metric", "dimensions"};
  std::vector<int> digits = {-1, -1, 0};
  for (const std::string& label : options.labels) {
    columns.insert(columns.end(), {label + " accuracy %", label + " entropy ban",
                                   label + " precision@" + std::to_string(options.query.k) + " %"});
    digits.insert(digits.end(), {1, 3, 1});
  }
  const std::string& excluded = options.query.exclude_same;
  Table table("nearest windows: split " + options.split + " against " + options.against + ", " +
                  (excluded == "none" ? "the same clip's too" : "without the same " + excluded),
              columns);
  table.digits(digits);
  return table;
}

void add_notes(Table& table, const SpectralIndex& index, const Dataset& dataset, const Sides& sides,
               const QueryEvaluation& options) {
  table.note(std::to_string(sides.queries.size()) + " windows of " +
             format_fixed(options.config.seconds(), 2) + " s against " +
             std::to_string(sides.findable.size()) + ", k = " + std::to_string(options.query.k));
  for (const std::string& label : options.labels)
    if (const std::size_t lone = lone_queries(index, dataset, sides, options, label); lone > 0)
      table.note(std::to_string(lone) + " of these windows have a " + label +
                 " that nothing they may find has: they count as wrong");
  if (index.clips_too_short() > 0)
    table.note(std::to_string(index.clips_too_short()) + " of " +
               std::to_string(index.clips().size()) + " clips are shorter than a window");
  Json settings = settings_json(options.config);
  settings.erase("feature");  // the rows name it
  table.note("settings: " + settings.dump());
  if (dataset.procedural) table.note("procedural dances: rules made them");
}

}  // namespace

std::string vote(const std::vector<std::string>& labels) {
  const std::map<std::string, std::size_t> counts = counts_of(labels);
  std::size_t most = 0;
  for (const auto& [label, count] : counts) most = std::max(most, count);
  for (const std::string& label : labels)
    if (counts.at(label) == most) return label;
  return "";
}

double entropy_in_bans(const std::vector<std::string>& labels) {
  double entropy = 0;
  for (const auto& [label, count] : counts_of(labels)) {
    const double p = static_cast<double>(count) / static_cast<double>(labels.size());
    entropy -= p * std::log10(p);
  }
  return entropy + 0.0;  // not -0
}

Table evaluate_query(const QueryEvaluation& options) {
  const Dataset dataset = load_dataset(options.dataset);
  check(options, dataset);
  Table table = empty_table(options);
  std::vector<Json> chance;
  for (const std::string& feature : options.features) {
    SpectralConfig config = options.config;
    config.feature = feature;
    const SpectralIndex index = index_of(dataset, config, options.keep, options.threads);
    const Sides sides = sides_of(index, dataset, options);
    for (const std::string& metric : options.metrics)
      table.row(scored_cells(index, dataset, sides, options, metric));
    if (!chance.empty()) continue;
    chance = chance_cells(index, dataset, sides, options);
    add_notes(table, index, dataset, sides, options);
  }
  table.row(chance);
  return table;
}

}  // namespace mocaplm
