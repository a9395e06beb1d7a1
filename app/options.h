// Binds the settings that a struct declares in `describe` (common/settings.h) to command line options:
// n_layer becomes --n-layer, with the declared range, default and help.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/table.h"

namespace mocaplm {

class BindOptions {
 public:
  explicit BindOptions(CLI::App& app) : app_(app) {}

  void integer(const char* key, std::int64_t& value, std::int64_t min, std::int64_t max, const char* help) {
    app_.add_option(flag(key), value, help)->check(CLI::Range(min, max))->capture_default_str();
  }
  void number(const char* key, double& value, double min, double max, const char* help) {
    // Range also refuses nan, which compares as neither inside nor outside.
    app_.add_option(flag(key), value, help)->check(CLI::Range(min, max))->check(finite())->capture_default_str();
  }
  void boolean(const char* key, bool& value, const char* help) {
    app_.add_flag(flag(key) + ",!" + "--no-" + flag(key).substr(2), value, help)->capture_default_str();
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& allowed, const char* help) {
    app_.add_option(flag(key), value, help)->check(CLI::IsMember(allowed))->capture_default_str();
  }
  void text(const char* key, std::string& value, const char* help) {
    app_.add_option(flag(key), value, help)->capture_default_str();
  }
  void texts(const char* key, std::vector<std::string>& value, const char* help) {
    app_.add_option(flag(key), value, help)->delimiter(',')->capture_default_str();
  }

  static CLI::Validator finite() {
    return CLI::Validator(
        [](std::string& text) { return text.find_first_of("nNfF") == std::string::npos ? "" : "expected a finite number"; },
        "FINITE");
  }

 private:
  static std::string flag(std::string key) {
    for (char& c : key)
      if (c == '_') c = '-';
    return "--" + key;
  }
  CLI::App& app_;
};

template <class Config>
void bind_options(CLI::App& app, Config& config) {
  BindOptions visitor(app);
  config.describe(visitor);
}

// Prints the table and, when `json_file` is not empty, writes its JSON there.
void print_table(const Table& table, const std::string& json_file);

}  // namespace mocaplm
