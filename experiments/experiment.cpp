#include "experiments/experiment.h"

#include <algorithm>
#include <set>

#include "common/error.h"

namespace mocaplm {

namespace {

// Every setting with its default, by section.
Json all_settings(bool classify) {
  Json all = to_json(RunConfig());
  if (classify) all["classify"] = settings_json(ClassifyConfig());
  return all;
}

// "model.n_layer=2" -> {"model": {"n_layer": 2}}; lists are separated by commas.
Json parse_set(const std::string& text, bool classify) {
  const auto equal = text.find('='), dot = text.find('.');
  if (equal == std::string::npos || dot == std::string::npos || dot > equal)
    throw UsageError("--set " + text + ": expected section.key=value, as in model.n_layer=2");
  const std::string section = text.substr(0, dot), key = text.substr(dot + 1, equal - dot - 1),
                    value = text.substr(equal + 1);
  const Json all = all_settings(classify);
  std::vector<std::string> sections, keys;
  for (const auto& item : all.items()) sections.push_back(item.key());
  if (!all.contains(section))
    throw UsageError("--set " + text + ": no section \"" + section + "\"" +
                     known_names(section, sections, "Sections"));
  const Json& settings = all[section];
  for (const auto& item : settings.items()) keys.push_back(item.key());
  if (!settings.contains(key))
    throw UsageError("--set " + text + ": " + section + " has no setting \"" + key + "\"" +
                     did_you_mean(key, keys));
  const Json& initial = settings[key];
  Json parsed = value;
  if (initial.is_array()) {
    parsed = value.empty() ? Json::array() : Json(split(value, ','));
  } else if (!initial.is_string()) {
    parsed = Json::parse(value, nullptr, /*allow_exceptions=*/false);
    if (parsed.is_discarded())
      throw UsageError("--set " + text + ": " + section + "." + key + " cannot be \"" + value +
                       "\"");
  }
  return {{section, {{key, parsed}}}};
}

struct Overrides {
  Json config = Json::object();    // of every row
  Json classify = Json::object();  // keys of that section
};

Overrides make_overrides(double minutes, const std::vector<std::string>& set, bool classify) {
  Overrides out;
  for (const std::string& text : set) {
    Json one = parse_set(text, classify);
    if (one.contains("classify"))
      out.classify.merge_patch(one["classify"]);
    else
      out.config.merge_patch(one);
  }
  if (minutes > 0) {
    out.config["train"]["max_minutes"] = minutes;
    out.classify["max_minutes"] = minutes;
  }
  // What the command line says is checked by itself, so that a message names it.
  try {
    run_config_from_json(out.config, "--set");
    JsonObject object(out.classify, "--set");
    ClassifyConfig unused;
    read_settings(unused, object);
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
  return out;
}

ExperimentRow read_row(const Json& json, const std::string& place, const Json& base,
                       const Json& overrides, const std::set<std::string>& earlier) {
  JsonObject object(json, place);
  ExperimentRow row;
  row.name = object.text("name");
  const std::string own = place + " \"" + row.name + "\"";
  if (row.name.empty()) object.fail("name", "expected a name");
  if (earlier.count(row.name) > 0) object.fail("name", "two rows are called \"" + row.name + "\"");
  row.line = object.has("row") ? object.text("row") : row.name;
  if (object.has("column")) row.column = object.text("column");
  if (object.has("data")) row.other_data = object.choice("data", {"own", "other"}) == "other";
  if (object.has("from")) {
    row.from = object.text("from");
    if (earlier.count(row.from) == 0)
      object.fail("from", "no earlier row is called \"" + row.from + "\"" +
                              known_names(row.from, {earlier.begin(), earlier.end()}, "Rows"));
  }
  Json config = base;
  if (object.has("change")) {
    const Json& change = object.raw("change");
    if (!change.is_object()) object.fail("change", "expected an object, found " + change.dump());
    config.merge_patch(change);
  }
  object.finish();
  config.merge_patch(overrides);
  row.config = run_config_from_json(config, own);
  return row;
}

}  // namespace

bool Experiment::needs_other_data() const {
  return std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.other_data; });
}

Experiment load_experiment(const std::filesystem::path& file, double minutes,
                           const std::vector<std::string>& set) {
  const std::string place = file.string();
  JsonObject top(load_json(file), place);
  Experiment experiment;
  experiment.title = top.text("title");
  const bool classifies = top.has("classify");
  const Overrides overrides = make_overrides(minutes, set, classifies);
  if (classifies) {
    Json section = top.raw("classify");
    if (!section.is_object()) top.fail("classify", "expected an object, found " + section.dump());
    section.merge_patch(overrides.classify);
    JsonObject object(section, place + ": \"classify\"");
    experiment.classify.emplace();
    read_settings(*experiment.classify, object);
    object.finish();
  }
  const Json base = top.has("config") ? top.raw("config") : Json::object();
  run_config_from_json(base, place + ": \"config\"");  // said once, not for every row
  const Json& rows = top.raw("rows");
  if (!rows.is_array() || rows.empty())
    top.fail("rows", "expected a list of rows, found " + rows.dump());
  top.finish();
  std::set<std::string> names;
  for (const Json& row : rows) {
    experiment.rows.push_back(read_row(row, place + ": row", base, overrides.config, names));
    names.insert(experiment.rows.back().name);
  }
  return experiment;
}

}  // namespace mocaplm
