// What a benchmark found, and its JSON, the same for all of them:
//
//   {"bench": "decode", "results": [{"name": "A int8 context 512 batch 1", "value": 2100.0,
//     "unit": "tokens/s", "limit": 4300.0, "limit_name": "memory bandwidth", "ratio": 0.49,
//     "goal": 0.5}]}
//
// limit (what the machine could do, or what a peer does, in the same unit), limit_name, ratio and
// goal are optional. The goal speaks of the ratio, or of the value with "goal_on": "value"; with
// "better": "less" it is an upper bound. "peer_of": "train/A" says that this is a peer's figure for
// the results of the benchmark `train` whose names begin with A; the goal is then theirs: how many
// times the peer's value they should reach. Other keys are carried along.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/json.h"

namespace mocaplm::bench {

struct Result {
  std::string name;
  double value = 0;
  std::string unit;
  std::optional<double> limit, ratio, goal;
  std::string limit_name;
  std::string peer_of;
  bool goal_on_value = false;
  bool less_is_better = false;

  // True, false, or nothing where there is no goal.
  std::optional<bool> reached() const;
};

// Of at least one value.
double median(std::vector<double> values);

// "build/bench/import_bench" -> "import".
std::string bench_name(const std::filesystem::path& program);

Json result_json(const Result& result);
void write_results(const std::filesystem::path& path, const std::string& bench,
                   const std::vector<Result>& results);

struct BenchRun {
  std::string bench;
  std::vector<Result> results;
};
// Reads one benchmark's JSON; `place` names it in errors. Throws DataError for another form.
BenchRun read_run(const Json& json, const std::string& place);

}  // namespace mocaplm::bench
