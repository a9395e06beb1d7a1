// Several runs of several benchmarks as one table: the median of each figure, peers beside what
// they are peers of, and on which machine all of it was measured.
#pragma once

#include <string>
#include <vector>

#include "bench/result.h"

namespace mocaplm::bench {

struct Collected {
  std::string bench;
  Result result;  // medians of value, limit and ratio, each over the runs that have it
  std::size_t runs = 0;
  double least = 0, most = 0;  // of the value
};

// In the order in which the results come first. A result with a peer follows as a second row:
// "beside" the peer's value, the ratio to it and the peer's goal.
std::vector<Collected> collect(const std::vector<BenchRun>& runs);

// Processor, cores, the instruction sets that matter here, memory, by /proc.
Json machine_json();

// Everything, as JSON and as a Markdown table. `versions`: name to version.
Json collected_json(const std::vector<Collected>& all, const Json& machine, const Json& versions);
std::string collected_markdown(const std::vector<Collected>& all, const Json& machine,
                               const Json& versions);

}  // namespace mocaplm::bench
