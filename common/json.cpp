#include "common/json.h"

#include <cmath>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"

namespace mocaplm {

namespace {

constexpr int kMaxDepth = 100;

// Copying and printing a JSON value recurse: a file of nothing but brackets would use up the stack.
void check_depth(const std::string& text, const std::string& name) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '[' || c == '{') && ++depth > kMaxDepth)
      throw DataError(at_byte(name, i),
                      "is nested deeper than " + std::to_string(kMaxDepth) + " lists and objects");
    else if (!quoted && (c == ']' || c == '}'))
      --depth;
  }
}

}  // namespace

Json parse_json(const std::string& text, const std::string& name) {
  check_depth(text, name);
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {  // also numbers such as 1e999
    // The library's text has "at line 3, column 7: ..." or "[json.exception...] ..."; its prefix
    // with an error number helps nobody.
    const std::string what = error.what();
    const auto at = what.find("at line "), end = what.find("] ");
    throw DataError(in_file(name), at != std::string::npos ? "is not valid JSON " + what.substr(at)
                                   : end != std::string::npos
                                       ? "is not valid JSON: " + what.substr(end + 2)
                                       : "is not valid JSON: " + what);
  }
}

Json load_json(const std::filesystem::path& path) {
  return parse_json(read_file(path), path.string());
}

void save_json(const std::filesystem::path& path, const Json& json) {
  write_file(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

JsonObject::JsonObject(const Json& json, std::string place)
    : json_(json), place_(std::move(place)) {
  if (!json_.is_object())
    throw DataError(in_file(place_),
                    std::string("expected a JSON object, found ") + json_.type_name());
}

void JsonObject::fail(const std::string& key, const std::string& message) const {
  throw DataError(in_file(place_), "\"" + key + "\": " + message);
}

bool JsonObject::has(const std::string& key) {
  known_.insert(key);
  return json_.contains(key);
}

const Json& JsonObject::raw(const std::string& key) {
  known_.insert(key);
  const auto found = json_.find(key);
  if (found == json_.end()) {
    std::vector<std::string> there;
    for (const auto& item : json_.items()) there.push_back(item.key());
    fail(key, "missing" + did_you_mean(key, there));
  }
  return *found;
}

std::int64_t JsonObject::integer(const std::string& key, std::int64_t min, std::int64_t max) {
  const Json& value = raw(key);
  const bool too_large = value.is_number_unsigned() &&
                         value.get<std::uint64_t>() >
                             static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!value.is_number_integer() || too_large)
    fail(key, "expected a whole number, found " + value.dump());
  const auto number = value.get<std::int64_t>();
  if (number < min || number > max)
    fail(key, "expected " + std::to_string(min) + " to " + std::to_string(max) + ", found " +
                  value.dump());
  return number;
}

double JsonObject::number(const std::string& key, double min, double max) {
  const Json& value = raw(key);
  if (!value.is_number()) fail(key, "expected a number, found " + value.dump());
  const double number = value.get<double>();
  if (!std::isfinite(number) || number < min || number > max)
    fail(key, "expected " + format_number(min) + " to " + format_number(max) + ", found " +
                  value.dump());
  return number;
}

bool JsonObject::boolean(const std::string& key) {
  const Json& value = raw(key);
  if (!value.is_boolean()) fail(key, "expected true or false, found " + value.dump());
  return value.get<bool>();
}

std::string JsonObject::text(const std::string& key) {
  const Json& value = raw(key);
  if (!value.is_string()) fail(key, "expected a text, found " + value.dump());
  return value.get<std::string>();
}

std::string JsonObject::choice(const std::string& key, const std::vector<std::string>& allowed) {
  const std::string value = text(key);
  for (const std::string& one : allowed)
    if (one == value) return value;
  fail(key, "expected one of " + join(allowed, ", ") + ", found \"" + value + "\"" +
                did_you_mean(value, allowed));
}

std::vector<std::string> JsonObject::texts(const std::string& key) {
  const Json& value = raw(key);
  if (!value.is_array()) fail(key, "expected a list of texts, found " + value.dump());
  std::vector<std::string> all;
  for (const Json& item : value) {
    if (!item.is_string()) fail(key, "expected a list of texts, found " + item.dump() + " in it");
    all.push_back(item.get<std::string>());
  }
  return all;
}

std::vector<double> JsonObject::numbers(const std::string& key) {
  const Json& value = raw(key);
  if (!value.is_array()) fail(key, "expected a list of numbers, found " + value.dump());
  std::vector<double> all;
  for (const Json& item : value) {
    if (!item.is_number() || !std::isfinite(item.get<double>()))
      fail(key, "expected a list of finite numbers, found " + item.dump() + " in it");
    all.push_back(item.get<double>());
  }
  return all;
}

JsonObject JsonObject::object(const std::string& key) {
  return JsonObject(raw(key), place_ + ": \"" + key + "\"");
}

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> all;
  for (const auto& item : json_.items()) all.push_back(item.key());
  return all;
}

void JsonObject::finish() const {
  const std::vector<std::string> allowed(known_.begin(), known_.end());
  for (const auto& item : json_.items())
    if (known_.count(item.key()) == 0)
      fail(item.key(), "unknown key" + did_you_mean(item.key(), allowed));
}

}  // namespace mocaplm
