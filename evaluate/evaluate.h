// A model's bits/frame on one split of a dataset beside the simple baselines fitted on its training
// split.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/table.h"
#include "evaluate/baselines.h"
#include "model/config.h"

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

// What some clips cost, channel by channel.
struct BitColumns {
  BitCount model;  // channels + 1 columns, the separator last
  std::vector<BitCount> orders = std::vector<BitCount>(Baselines::kOrders);  // channels columns
};

struct SplitBits {
  ModelDescription model;
  Tokenizer tokenizer;
  std::map<std::string, BitColumns> groups;  // by the value of `by`; one of the name "" without it
};

// The numbers of evaluate_tables, with its errors.
SplitBits split_bits(const EvaluateOptions& options);

// One table for each value of `by`, else one. Throws DataError or UsageError when something does
// not fit.
std::vector<Table> evaluate_tables(const EvaluateOptions& options);

}  // namespace mocaplm
