#include "bench/result.h"

#include <algorithm>

#include "common/error.h"

namespace mocaplm::bench {

namespace {

void set(Json& json, const char* key, const std::optional<double>& value) {
  if (value) json[key] = *value;
}

std::optional<double> number(JsonObject& object, const char* key) {
  if (!object.has(key)) return {};
  return object.number(key);
}

std::string text(JsonObject& object, const char* key) {
  return object.has(key) ? object.text(key) : "";
}

Result read_result(JsonObject object) {
  Result result;
  result.name = object.text("name");
  result.value = object.number("value");
  result.unit = object.text("unit");
  result.limit = number(object, "limit");
  result.limit_name = text(object, "limit_name");
  result.ratio = number(object, "ratio");
  result.goal = number(object, "goal");
  result.peer_of = text(object, "peer_of");
  if (object.has("goal_on"))
    result.goal_on_value = object.choice("goal_on", {"ratio", "value"}) == "value";
  if (object.has("better"))
    result.less_is_better = object.choice("better", {"more", "less"}) == "less";
  return result;
}

}  // namespace

std::optional<bool> Result::reached() const {
  if (!goal || !peer_of.empty() || (!goal_on_value && !ratio)) return {};
  const double found = goal_on_value ? value : *ratio;
  return less_is_better ? found <= *goal : found >= *goal;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

std::string bench_name(const std::filesystem::path& program) {
  const std::string stem = program.stem().string(), end = "_bench";
  const bool ends =
      stem.size() > end.size() && stem.compare(stem.size() - end.size(), end.size(), end) == 0;
  return ends ? stem.substr(0, stem.size() - end.size()) : stem;
}

Json result_json(const Result& result) {
  Json json{{"name", result.name}, {"value", result.value}, {"unit", result.unit}};
  set(json, "limit", result.limit);
  if (!result.limit_name.empty()) json["limit_name"] = result.limit_name;
  set(json, "ratio", result.ratio);
  set(json, "goal", result.goal);
  if (result.goal_on_value) json["goal_on"] = "value";
  if (result.less_is_better) json["better"] = "less";
  if (!result.peer_of.empty()) json["peer_of"] = result.peer_of;
  return json;
}

void write_results(const std::filesystem::path& path, const std::string& bench,
                   const std::vector<Result>& results) {
  Json list = Json::array();
  for (const Result& result : results) list.push_back(result_json(result));
  save_json(path, Json{{"bench", bench}, {"results", list}});
}

BenchRun read_run(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  BenchRun run;
  run.bench = object.text("bench");
  const Json& list = object.raw("results");
  if (!list.is_array()) object.fail("results", "expected a list");
  for (std::size_t i = 0; i < list.size(); ++i)
    run.results.push_back(
        read_result(JsonObject(list[i], place + ": result " + std::to_string(i + 1))));
  return run;
}

}  // namespace mocaplm::bench
