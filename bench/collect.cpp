#include "bench/collect.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "common/text.h"

namespace mocaplm::bench {

namespace {

std::optional<double> median_of(const std::vector<Result>& runs,
                                std::optional<double> Result::*member) {
  std::vector<double> values;
  for (const Result& run : runs)
    if (run.*member) values.push_back(*(run.*member));
  if (values.empty()) return {};
  return median(values);
}

Collected middle(const std::string& bench, const std::vector<Result>& runs) {
  Collected all{bench, runs.front(), runs.size()};
  std::vector<double> values;
  for (const Result& run : runs) values.push_back(run.value);
  all.least = *std::min_element(values.begin(), values.end());
  all.most = *std::max_element(values.begin(), values.end());
  all.result.value = median(values);
  all.result.limit = median_of(runs, &Result::limit);
  all.result.ratio = median_of(runs, &Result::ratio);
  return all;
}

bool is_peer_of(const Collected& peer, const Collected& ours) {
  const std::string& of = peer.result.peer_of;
  if (of.empty() || !ours.result.peer_of.empty() || ours.result.unit != peer.result.unit)
    return false;
  const std::string full = ours.bench + "/" + ours.result.name;
  return full.compare(0, of.size(), of) == 0 &&
         (full.size() == of.size() ||
          std::isalnum(static_cast<unsigned char>(full[of.size()])) == 0);
}

Collected beside(const Collected& ours, const Collected& peer) {
  Collected row = ours;
  row.result.limit = peer.result.value;
  row.result.limit_name = peer.result.name + " (" + peer.bench + ")";
  row.result.ratio = ours.result.value / peer.result.value;
  row.result.goal = peer.result.goal;
  row.result.goal_on_value = false;
  return row;
}

// Three significant digits, whole from 100 on, thousands apart: 0.0123, 45.6, 12,300.
std::string shown(double value) {
  if (value == 0 || !std::isfinite(value)) return format_number(value);
  const int digits = std::max(0, 2 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  std::string text = format_fixed(value, digits);
  if (digits == 0)
    for (std::size_t at = text.size(); at > 3 && text[at - 4] != '-'; at -= 3)
      text.insert(at - 3, ",");
  return text;
}

std::string shown(const std::optional<double>& value) {
  return value ? shown(*value) : "";
}

std::string goal_text(const Result& result) {
  if (!result.goal || !result.peer_of.empty()) return "";
  const std::string bound = (result.less_is_better ? "at most " : "") + shown(*result.goal) +
                            (result.goal_on_value ? " " + result.unit : "");
  const std::optional<bool> reached = result.reached();
  return bound + (!reached ? "" : *reached ? ", reached" : ", **missed**");
}

// The value behind "name : value" in a file of /proc; "" when it is not there.
std::string proc_value(const std::string& file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || line.compare(0, name.size(), name) != 0) continue;
    if (line.find_first_not_of(" \t", name.size()) != colon) continue;
    const std::size_t from = line.find_first_not_of(" \t", colon + 1);
    return from == std::string::npos ? "" : line.substr(from);
  }
  return "";
}

int logical_cores() {
  std::ifstream in("/proc/cpuinfo");
  int count = 0;
  for (std::string line; std::getline(in, line);) count += line.compare(0, 9, "processor") == 0;
  return count;
}

std::vector<std::string> flags_that_matter() {
  std::istringstream in(proc_value("/proc/cpuinfo", "flags"));
  std::vector<std::string> flags;
  for (std::string flag; in >> flag;)
    for (const char* known : {"avx2", "fma", "avx512f", "avx512bw", "avx512_vnni", "avx512_bf16",
                              "avx_vnni", "amx_bf16", "amx_int8"})
      if (flag == known) flags.push_back(flag);
  return flags;
}

}  // namespace

std::vector<Collected> collect(const std::vector<BenchRun>& runs) {
  std::vector<std::pair<std::string, std::string>> order;
  std::map<std::pair<std::string, std::string>, std::vector<Result>> results;
  for (const BenchRun& run : runs)
    for (const Result& result : run.results) {
      const auto key = std::make_pair(run.bench, result.name);
      if (results[key].empty()) order.push_back(key);
      results[key].push_back(result);
    }
  std::vector<Collected> all, rows;
  for (const auto& key : order) all.push_back(middle(key.first, results[key]));
  for (const Collected& one : all) {
    rows.push_back(one);
    for (const Collected& peer : all)
      if (is_peer_of(peer, one)) rows.push_back(beside(one, peer));
  }
  return rows;
}

Json machine_json() {
  std::istringstream memory(proc_value("/proc/meminfo", "MemTotal"));
  double kib = 0;
  memory >> kib;
  return Json{{"processor", proc_value("/proc/cpuinfo", "model name")},
              {"cores", logical_cores()},
              {"instruction_sets", flags_that_matter()},
              {"memory_gib", std::round(kib / 104857.6) / 10}};
}

Json collected_json(const std::vector<Collected>& all, const Json& machine, const Json& versions) {
  Json rows = Json::array();
  for (const Collected& one : all) {
    Json row{{"bench", one.bench}};
    row.update(result_json(one.result));
    if (const std::optional<bool> reached = one.result.reached()) row["reached"] = *reached;
    row.update(Json{{"runs", one.runs}, {"least", one.least}, {"most", one.most}});
    rows.push_back(row);
  }
  return Json{{"machine", machine}, {"versions", versions}, {"results", rows}};
}

std::string collected_markdown(const std::vector<Collected>& all, const Json& machine,
                               const Json& versions) {
  std::string text =
      "| what | achieved | limit or peer | ratio | goal |\n|---|---:|---:|---:|---|\n";
  for (const Collected& one : all) {
    const Result& result = one.result;
    std::string limit = shown(result.limit);
    if (!result.limit_name.empty()) limit += (limit.empty() ? "" : ", ") + result.limit_name;
    text += "| " + one.bench + ": " + result.name + " | " + shown(result.value) + " " +
            result.unit + " | " + limit + " | " + shown(result.ratio) + " | " + goal_text(result) +
            " |\n";
  }
  std::size_t runs = 0;
  for (const Collected& one : all) runs = std::max(runs, one.runs);
  text += "\nMedian of " + std::to_string(runs) + (runs == 1 ? " run" : " runs") + " on " +
          machine["processor"].get<std::string>() + ", " +
          std::to_string(machine["cores"].get<int>()) + " cores (" +
          join(machine["instruction_sets"].get<std::vector<std::string>>(), ", ") + "), " +
          format_number(machine["memory_gib"].get<double>()) + " GiB.";
  for (const auto& item : versions.items())
    text += " " + item.key() + " " + item.value().get<std::string>() + ".";
  return text + "\n";
}

}  // namespace mocaplm::bench
