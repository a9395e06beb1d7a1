// A model's bits/frame on one split of a dataset beside the simple baselines fitted on its training
// split.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/table.h"

namespace mocaplm {

struct EvaluateOptions {
  std::filesystem::path model, data;
  std::string split = "test";
  std::vector<std::string> where;  // "label=value": only these clips, in both splits
  std::string by;                  // a label: one table for each of its values
  bool conditions = true;          // tell the model the clips' labels, where it knows conditions
  std::string device = "auto", precision = "auto";
  std::string engine;  // a Precision: score by the engine that generates instead of LibTorch
  int threads = 0;
};

// One table for each value of `by`, else one. Throws DataError or UsageError when something does
// not fit.
std::vector<Table> evaluate_tables(const EvaluateOptions& options);

}  // namespace mocaplm
