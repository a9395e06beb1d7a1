// A table of the thesis (4.4, 4.5, 4.6, 4.8), or any other comparison, as a file:
//
//   {"title": "Table 4.6: ...",
//    "config": {"tokenizer": {...}, "model": {...}, "train": {...}},     of all rows
//    "classify": {...},                                                  only for classification
//    "rows": [{"name": "pre-training", "data": "other"},
//             {"name": "fine-tuning", "from": "pre-training", "change": {"train": {...}}},
//             {"name": "absolute, masked", "row": "Absolute", "column": "Masked", ...}]}
//
// "change" is laid over "config" (RFC 7396: objects are merged, all else replaced). "data" says
// what a row is trained on: the dataset that all are tested on ("own", the default) or the other
// one. "row" and "column" place a row in the printed table; by default each has a line of its own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "classify/config.h"
#include "train/config.h"

namespace mocaplm {

struct ExperimentRow {
  std::string name;  // unique
  std::string line, column;
  RunConfig config;
  std::string from;  // name of an earlier row, or ""
  bool other_data = false;
};

struct Experiment {
  std::string title;
  std::vector<ExperimentRow> rows;
  std::optional<ClassifyConfig> classify;  // each row's model becomes a classifier

  bool needs_other_data() const;
};

// `minutes` (0: as the file says) is the time of each training, `set` holds "model.n_layer=2" and
// the like; both win over the file in every row. Throws DataError when the file is not such a table
// (unknown keys and rows, two rows of one name), UsageError when `set` names no setting or a value
// it cannot have.
Experiment load_experiment(const std::filesystem::path& file, double minutes = 0,
                           const std::vector<std::string>& set = {});

}  // namespace mocaplm
