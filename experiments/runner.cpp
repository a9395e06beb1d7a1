#include "experiments/runner.h"

#include <cctype>
#include <cstdio>
#include <set>

#include "classify/train.h"
#include "common/error.h"
#include "common/files.h"
#include "common/random.h"
#include "evaluate/evaluate.h"
#include "experiments/report.h"
#include "model/directory.h"
#include "motion/dataset.h"
#include "train/trainer.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

struct RowPlace {
  fs::path folder;

  fs::path request() const { return folder / "request.json"; }
  fs::path run() const { return folder / "run"; }
  fs::path classifier() const { return folder / "classifier"; }
  fs::path result() const { return folder / "result.json"; }
};

RowPlace place_of(const ExperimentOptions& options, const std::string& row) {
  return {options.out / row_folder(row)};
}

fs::path data_of(const ExperimentRow& row, const ExperimentOptions& options) {
  return row.other_data ? options.other_data : options.data;
}

// All that a row's result depends on; a row that is there must have been asked for in this way.
Json request_of(const Experiment& experiment, const ExperimentRow& row,
                const ExperimentOptions& options) {
  return {{"name", row.name},
          {"row", row.line},
          {"column", row.column},
          {"config", to_json(row.config)},
          {"from", row.from},
          {"trained on", fs::absolute(data_of(row, options)).lexically_normal().string()},
          {"tested on", fs::absolute(options.data).lexically_normal().string()},
          {"split", options.split},
          {"classify", experiment.classify ? settings_json(*experiment.classify) : Json(nullptr)}};
}

void check(const Experiment& experiment, const ExperimentOptions& options) {
  if (experiment.needs_other_data() && options.other_data.empty())
    throw UsageError("--other-data: a row is trained on another dataset than it is tested on");
  if (fs::exists(options.out) && !fs::is_directory(options.out))
    throw UsageError(options.out.string() + " is a file, expected a folder");
  std::set<std::string> folders;
  for (const ExperimentRow& row : experiment.rows) {
    const RowPlace place = place_of(options, row.name);
    if (!folders.insert(place.folder.string()).second)
      throw UsageError("two rows would share the folder " + place.folder.string() +
                       ": give them names of other letters");
    if (fs::exists(place.request())) {
      if (load_json(place.request()) != request_of(experiment, row, options))
        throw UsageError(place.folder.string() + " holds the row \"" + row.name +
                         "\" of other settings (request.json): give another --out");
    } else if (fs::exists(place.folder) && !fs::is_empty(place.folder)) {
      throw UsageError(place.folder.string() +
                       " is not empty and holds no row: give another --out");
    }
  }
}

// Clips that are tested on and, in the other dataset, trained on.
std::size_t seen_before(const ExperimentOptions& options) {
  std::set<std::string> tested;
  for (const DatasetEntry& entry : load_dataset(options.data).split(options.split))
    tested.insert(entry.source);
  std::size_t seen = 0;
  for (const DatasetEntry& entry : load_dataset(options.other_data).split("train"))
    seen += tested.count(entry.source);
  return seen;
}

// Goes on with the run where there is a checkpoint; what was cut off before the first is removed.
void train_row(const ExperimentRow& row, const ExperimentOptions& options) {
  const RowPlace place = place_of(options, row.name);
  TrainOptions train_options;
  train_options.out = place.run();
  train_options.data = data_of(row, options);
  train_options.device = options.device;
  train_options.threads = options.threads;
  train_options.config = row.config;
  if (fs::exists(place.run() / "last" / "complete")) {
    train_options.resume = true;
  } else {
    fs::remove_all(place.run());
    if (!row.from.empty()) train_options.from = place_of(options, row.from).run();
  }
  train(train_options);
}

void describe_run(RowResult& result, const fs::path& run) {
  const fs::path file = run / "last" / "state.json";
  JsonObject state(load_json(file), file.string());
  result.steps = state.integer("step", 0);
  result.minutes = state.number("seconds", 0) / 60;
  result.parameters = static_cast<std::int64_t>(parameter_count(load_description(run / "last")));
}

void test_language(RowResult& result, const fs::path& run, const ExperimentOptions& options) {
  EvaluateOptions evaluate;
  evaluate.model = run;
  evaluate.data = options.data;
  evaluate.split = options.split;
  evaluate.device = options.device;
  evaluate.threads = options.threads;
  const SplitBits bits = split_bits(evaluate);
  const BitColumns& columns = bits.groups.at("");
  result.fps = bits.tokenizer.config().fps;
  result.bins = bits.tokenizer.config().bins;
  result.binning = bits.tokenizer.config().binning;
  result.joints = bits.tokenizer.joints();
  result.frames = columns.model.frames;
  result.predicted = bits.model.predicted_per_frame();
  result.masked = bits.model.masked();
  for (int c = 0; c <= bits.tokenizer.channels(); ++c)
    result.bits.push_back(columns.model.per_frame(c, 1));
  for (int c = 0; c < bits.tokenizer.channels(); ++c)
    result.order_2.push_back(columns.orders.back().per_frame(c, 1));
}

void test_classifier(RowResult& result, const RowPlace& place, const ClassifyConfig& config,
                     const ExperimentOptions& options) {
  ClassifyOptions classify_options;
  classify_options.model = place.run();
  classify_options.data = options.data;
  classify_options.out = place.classifier();
  classify_options.split = options.split;
  classify_options.config = config;
  classify_options.device = options.device;
  classify_options.threads = options.threads;
  const ClassifyResult scores = classify(classify_options);
  for (const MethodScores& method : scores.methods) {
    MethodAccuracy accuracy{method.method, {}};
    for (std::size_t k = 0; k < scores.tasks.size(); ++k)
      accuracy.labels.emplace_back(scores.tasks[k].label, method.tasks[k].window_accuracy);
    result.accuracy.push_back(accuracy);
  }
}

RowResult finish_row(const Experiment& experiment, const ExperimentRow& row,
                     const ExperimentOptions& options) {
  const RowPlace place = place_of(options, row.name);
  if (fs::exists(place.result()))
    return result_from_json(load_json(place.result()), place.result().string());
  save_json(place.request(), request_of(experiment, row, options));
  train_row(row, options);
  RowResult result;
  result.name = row.name;
  result.line = row.line;
  result.column = row.column;
  describe_run(result, place.run());
  if (experiment.classify)
    test_classifier(result, place, *experiment.classify, options);
  else
    test_language(result, place.run(), options);
  save_json(place.result(), to_json(result));
  return result;
}

Json table_json(const Experiment& experiment, const std::vector<RowResult>& rows,
                const std::vector<Table>& tables) {
  Json all = {{"title", experiment.title}, {"rows", Json::array()}, {"tables", Json::array()}};
  for (const RowResult& row : rows) all["rows"].push_back(to_json(row));
  for (const Table& table : tables) all["tables"].push_back(table.json());
  return all;
}

}  // namespace

std::string row_folder(const std::string& name) {
  std::string folder;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      folder += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!folder.empty() && folder.back() != '-')
      folder += '-';
  }
  while (!folder.empty() && folder.back() == '-') folder.pop_back();
  return folder.empty() ? "row-" + hex(stable_hash(name)) : folder;
}

std::vector<Table> run_experiment(const Experiment& experiment, const ExperimentOptions& options) {
  check(experiment, options);
  const Dataset dataset = load_dataset(options.data);
  if (dataset.split(options.split).empty())
    throw DataError(in_file(options.data.string()), "the split \"" + options.split + "\" is empty");
  const std::size_t seen = experiment.needs_other_data() ? seen_before(options) : 0;
  std::vector<RowResult> results;
  for (const ExperimentRow& row : experiment.rows) {
    std::fprintf(stderr, "row %zu of %zu: %s\n", results.size() + 1, experiment.rows.size(),
                 row.name.c_str());
    results.push_back(finish_row(experiment, row, options));
  }
  std::vector<Table> tables = experiment_tables(experiment.title, results, options.split);
  if (dataset.procedural) tables[0].note("procedural dances: rules made them");
  if (seen > 0)
    tables[0].note(std::to_string(seen) + " of the clips tested on are in the training split of " +
                   options.other_data.string() + ": rows trained on it have seen them");
  save_json(options.out / "table.json", table_json(experiment, results, tables));
  return tables;
}

}  // namespace mocaplm
