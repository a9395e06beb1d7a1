// A setting is declared once, with its type, range, default and help, in its struct's `describe`:
//
//   struct ModelConfig {
//     std::int64_t n_layer = 4;
//     template <class Visitor> void describe(Visitor& v) {
//       v.integer("n_layer", n_layer, 1, 96, "transformer blocks");
//     }
//   };
//
// The visitors below read it from JSON, write it to JSON and list it; app/options.h binds it to
// CLI11.
#pragma once

#include <string>
#include <vector>

#include "common/json.h"
#include "common/text.h"

namespace mocaplm {

// Keys that are missing keep their default; unknown keys are refused by JsonObject::finish.
class ReadSettings {
 public:
  explicit ReadSettings(JsonObject& object) : object_(object) {}
  void integer(const char* key, std::int64_t& value, std::int64_t min, std::int64_t max,
               const char*) {
    if (object_.has(key)) value = object_.integer(key, min, max);
  }
  void number(const char* key, double& value, double min, double max, const char*) {
    if (object_.has(key)) value = object_.number(key, min, max);
  }
  void boolean(const char* key, bool& value, const char*) {
    if (object_.has(key)) value = object_.boolean(key);
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& allowed,
              const char*) {
    if (object_.has(key)) value = object_.choice(key, allowed);
  }
  void text(const char* key, std::string& value, const char*) {
    if (object_.has(key)) value = object_.text(key);
  }
  void texts(const char* key, std::vector<std::string>& value, const char*) {
    if (object_.has(key)) value = object_.texts(key);
  }

 private:
  JsonObject& object_;
};

class WriteSettings {
 public:
  explicit WriteSettings(Json& json) : json_(json) {}
  void integer(const char* key, std::int64_t& value, std::int64_t, std::int64_t, const char*) {
    json_[key] = value;
  }
  void number(const char* key, double& value, double, double, const char*) { json_[key] = value; }
  void boolean(const char* key, bool& value, const char*) { json_[key] = value; }
  void choice(const char* key, std::string& value, const std::vector<std::string>&, const char*) {
    json_[key] = value;
  }
  void text(const char* key, std::string& value, const char*) { json_[key] = value; }
  void texts(const char* key, std::vector<std::string>& value, const char*) { json_[key] = value; }

 private:
  Json& json_;
};

template <class Config>
void read_settings(Config& config, JsonObject& object) {
  ReadSettings visitor(object);
  config.describe(visitor);
}

template <class Config>
Json settings_json(Config config) {
  Json json = Json::object();
  WriteSettings visitor(json);
  config.describe(visitor);
  return json;
}

}  // namespace mocaplm
