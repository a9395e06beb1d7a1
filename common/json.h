// Strict JSON: every key is known, every number is finite and in its range, every error names the
// key.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace mocaplm {

using Json = nlohmann::ordered_json;

// Parses a file; DataError names the line and column of a syntax error.
Json load_json(const std::filesystem::path& path);
Json parse_json(const std::string& text, const std::string& name);
void save_json(const std::filesystem::path& path, const Json& json);

// Reads one JSON object key by key and refuses what nobody asked for.
//   JsonObject object(json, "run/config.json");
//   n_layer = object.integer("n_layer", 1, 96);
//   object.finish();  // throws DataError on unknown keys, with the nearest known one
class JsonObject {
 public:
  JsonObject(const Json& json, std::string place);

  bool has(const std::string& key);
  std::int64_t integer(const std::string& key,
                       std::int64_t min = std::numeric_limits<std::int64_t>::min(),
                       std::int64_t max = std::numeric_limits<std::int64_t>::max());
  double number(const std::string& key, double min = -std::numeric_limits<double>::max(),
                double max = std::numeric_limits<double>::max());
  bool boolean(const std::string& key);
  std::string text(const std::string& key);
  std::string choice(const std::string& key, const std::vector<std::string>& allowed);
  std::vector<std::string> texts(const std::string& key);
  std::vector<double> numbers(const std::string& key);
  JsonObject object(const std::string& key);
  const Json& raw(const std::string& key);  // throws when missing
  std::vector<std::string> keys() const;

  void finish() const;
  const std::string& place() const { return place_; }
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

 private:
  Json json_;
  std::string place_;
  std::set<std::string> known_;
};

}  // namespace mocaplm
