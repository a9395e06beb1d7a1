// The main of the google-benchmark executables: their usual options, and `--json FILE` for the
// form that bench/collect reads. What a benchmark says of itself it says in counters:
//
//   "frames/s" (any name with a '/')  the value and its unit
//   "of memory bandwidth"             the ratio, and the name of the limit or peer
//   "goal"                            what the ratio should reach
//   "goal of value"                   what the value should reach, in its unit
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "bench/result.h"

namespace {

using namespace mocaplm::bench;

class Reporter : public benchmark::ConsoleReporter {
 public:
  Reporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      failed_ |= run.error_occurred;
      if (!run.error_occurred && run.run_type == Run::RT_Iteration) results_.push_back(of(run));
    }
  }
  const std::vector<Result>& results() const { return results_; }
  bool failed() const { return failed_; }

 private:
  static Result of(const Run& run) {
    Result result;
    result.name = run.report_label.empty() ? run.benchmark_name() : run.report_label;
    for (const auto& [name, counter] : run.counters) {
      if (name == "goal" || name == "goal of value") {
        result.goal = counter.value;
        result.goal_on_value = name != "goal";
      } else if (name.rfind("of ", 0) == 0) {
        result.ratio = counter.value;
        result.limit_name = name.substr(3);
      } else if (name.find('/') != std::string::npos) {
        result.value = counter.value;
        result.unit = name;
      }
    }
    if (result.ratio) result.limit = result.value / *result.ratio;
    return result;
  }

  std::vector<Result> results_;
  bool failed_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  std::string json;
  std::vector<char*> left = {argv[0]};
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--json") == 0 && i + 1 < argc)
      json = argv[++i];
    else
      left.push_back(argv[i]);
  }
  int count = static_cast<int>(left.size());
  left.push_back(nullptr);
  benchmark::Initialize(&count, left.data());
  if (benchmark::ReportUnrecognizedArguments(count, left.data())) return 2;
  Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  if (reporter.results().empty() || reporter.failed()) {
    std::fprintf(stderr, "%s: no benchmark ran to its end\n", argv[0]);
    return 1;
  }
  if (!json.empty()) write_results(json, bench_name(argv[0]), reporter.results());
  return 0;
}
