#include <algorithm>
#include <map>

#include "app/described_parts.h"
#include "common/error.h"
#include "common/text.h"
#include "motion/formats/retarget_map.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

struct JsonKind {
  const char* what;
  std::vector<const char*> keys;  // that all such files have
};

const std::vector<JsonKind>& json_kinds() {
  static const std::vector<JsonKind> kinds = {
      {"description of a model (config.json)", {"format", "model", "stream"}},
      {"table of an experiment", {"title", "rows", "tables"}},
      {"request of an experiment's row", {"name", "config", "trained on", "tested on"}},
      {"result of an experiment's row", {"name", "bits_of_a_frame", "accuracy"}},
      {"table", {"title", "columns", "rows"}},
      {"experiment", {"title", "config", "rows"}},
      {"settings of a training run", {"config", "data", "from"}},
      {"state of a training run", {"step", "best_nats", "seconds"}},
      {"learning-rate range test", {"rates", "losses", "proposed"}},
      {"tables of a classifier", {"settings", "data", "tables"}},
      {"report of an import", {"imported", "ignored", "broken"}},
      {"files of a model (complete)", {"config.json", "model.safetensors"}}};
  return kinds;
}

bool only_has(const Json& json, const std::vector<std::string>& keys) {
  for (const auto& item : json.items())
    if (std::find(keys.begin(), keys.end(), item.key()) == keys.end()) return false;
  return !json.empty();
}

// Of files that say what they are, and have no reader of their own.
const std::map<std::string, const char*> kFormats = {{"mocaplm corpus", "index of a text corpus"},
                                                     {"mocaplm demo", "marker of a demo"}};

const JsonKind* kind_of(const Json& json) {
  const auto has = [&](const char* key) { return json.contains(key); };
  for (const JsonKind& kind : json_kinds())
    if (std::all_of(kind.keys.begin(), kind.keys.end(), has)) return &kind;
  return nullptr;
}

Json brief(const Json& value) {
  if (value.is_array())
    return std::to_string(value.size()) + (value.size() == 1 ? " entry" : " entries");
  if (!value.is_object()) return value;
  std::vector<std::string> keys;
  for (const auto& item : value.items()) keys.push_back(item.key());
  return value_text(keys);
}

Table summary(const std::string& place, const std::string& what, const Json& json) {
  Table table(place, {what, "value"});
  for (const auto& item : json.items())
    if (item.key() != "format" && item.key() != "version")
      table.row({item.key(), brief(item.value())});
  return table;
}

bool is_table(const Json& json) {
  return json.is_object() && json.contains("title") && json.contains("columns") &&
         json.contains("rows") && json["columns"].is_array() && json["rows"].is_array();
}

Table describe_table(const std::string& place, const Json& json) {
  Table table(place, {"table", text_of(json, "title")});
  std::vector<std::string> columns;
  for (const Json& column : json["columns"])
    columns.push_back(column.is_string() ? column.get<std::string>() : column.dump());
  table.row({"columns", value_text(columns)});
  table.row({"rows", json["rows"].size()});
  return table;
}

[[noreturn]] void unknown(const fs::path& file, const Json& json) {
  std::vector<std::string> keys;
  if (json.is_object())
    for (const auto& item : json.items()) keys.push_back("\"" + item.key() + "\"");
  if (keys.size() > 8) keys.resize(8);
  throw DataError(in_file(file.string()),
                  "is JSON, but nothing that this program reads or writes" +
                      (keys.empty() ? std::string(json.is_array() ? " (a list)" : "")
                                    : " (its keys: " + join(keys, ", ") + ")"));
}

Table describe_settings(const fs::path& file, const Json& json) {
  Table table(file.string(), {"settings for train --config", "given"});
  for (const auto& section : json.items()) {
    if (!section.value().is_object()) {
      table.row({section.key(), section.value()});
      continue;
    }
    for (const auto& setting : section.value().items())
      table.row({section.key() + "." + setting.key(),
                 setting.value().is_array() ? Json(setting.value().dump()) : setting.value()});
  }
  table.note("All others are at their defaults, see docs/settings.md.");
  return table;
}

std::vector<Table> describe_list(const fs::path& file, const Json& json) {
  std::vector<Table> tables;
  for (const Json& item : json)
    if (is_table(item)) tables.push_back(describe_table(file.string(), item));
  if (!tables.empty() && tables.size() == json.size()) return tables;
  if (!json.empty() && json[0].is_object() && json[0].contains("logits")) {
    Table table(file.string(), {"self-test of a model", "value"});
    table.row({"windows with their logits", json.size()});
    return {table};
  }
  unknown(file, json);
}

}  // namespace

std::vector<Table> describe_json(const fs::path& file, const Json& json) {
  if (json.is_array()) return describe_list(file, json);
  if (!json.is_object()) unknown(file, json);
  if (is_table(json)) return {describe_table(file.string(), json)};
  if (only_has(json, {"tokenizer", "pieces", "model", "train"}))
    return {describe_settings(file, json)};
  if (json.contains("joints") &&
      only_has(json, {"joints", "t_pose", "up", "facing", "unit", "align"})) {
    load_map(file);
    return {summary(file.string(), "map of a BVH skeleton", json)};
  }
  const std::string format = text_of(json, "format");
  if (const auto found = kFormats.find(format); found != kFormats.end())
    return {summary(file.string(), found->second, json)};
  if (!format.empty())
    throw DataError(in_file(file.string()),
                    "has the format \"" + format + "\", which is not known");
  const JsonKind* kind = kind_of(json);
  if (kind == nullptr) unknown(file, json);
  return {summary(file.string(), kind->what, json)};
}

}  // namespace mocaplm
