// Binds the settings that a struct declares in `describe` (common/settings.h) to command line
// options: n_layer becomes --n-layer, with the declared range, default and help.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/settings.h"
#include "common/table.h"

namespace mocaplm {

// One of some names; an error says which is the nearest.
inline CLI::Validator one_of(const std::vector<std::string>& allowed) {
  return CLI::Validator(
      [allowed](std::string& given) {
        for (const std::string& name : allowed)
          if (name == given) return std::string();
        return "\"" + given + "\" is not known" + known_names(given, allowed, "One of");
      },
      "{" + join(allowed, ",") + "}");
}

// n_layer -> --n-layer
inline std::string option_flag(std::string key) {
  for (char& c : key)
    if (c == '_') c = '-';
  return "--" + key;
}

class BindOptions {
 public:
  explicit BindOptions(CLI::App& app) : app_(app) {}

  void integer(const char* key, std::int64_t& value, std::int64_t min, std::int64_t max,
               const char* help) {
    app_.add_option(flag(key), value, help)->check(CLI::Range(min, max))->capture_default_str();
  }
  void number(const char* key, double& value, double min, double max, const char* help) {
    // Range also refuses nan, which compares as neither inside nor outside.
    app_.add_option(flag(key), value, help)
        ->check(CLI::Range(min, max))
        ->check(finite())
        ->capture_default_str();
  }
  void boolean(const char* key, bool& value, const char* help) {
    // A flag has no text of its own for its default.
    app_.add_flag(flag(key) + ",!" + "--no-" + flag(key).substr(2), value, help)
        ->default_str(value ? "true" : "false");
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& allowed,
              const char* help) {
    app_.add_option(flag(key), value, help)->check(one_of(allowed))->capture_default_str();
  }
  void text(const char* key, std::string& value, const char* help) {
    app_.add_option(flag(key), value, help)->capture_default_str();
  }
  void texts(const char* key, std::vector<std::string>& value, const char* help) {
    app_.add_option(flag(key), value, help)->delimiter(',')->capture_default_str();
  }

  static CLI::Validator finite() {
    return CLI::Validator(
        [](std::string& text) {
          return text.find_first_of("nNfF") == std::string::npos ? "" : "expected a finite number";
        },
        "FINITE");
  }

 private:
  // A key of one letter is also a short option: -k.
  static std::string flag(const std::string& key) {
    return (key.size() == 1 ? "-" + key + "," : "") + option_flag(key);
  }
  CLI::App& app_;
};

template <class Config>
void bind_options(CLI::App& app, Config& config) {
  BindOptions visitor(app);
  config.describe(visitor);
}

// Copies into `config` only those settings that the user gave on the command line (parsed into
// `given`): a config file's value stays unless an option overrides it.
template <class Config>
void overlay_options(const CLI::App& app, Config& given, Config& config) {
  Json used = Json::object();
  const Json all = settings_json(given);
  for (const auto& item : all.items()) {
    const CLI::Option* option = app.get_option_no_throw(option_flag(item.key()));
    if (option != nullptr && option->count() > 0) used[item.key()] = item.value();
  }
  JsonObject object(used, "command line");
  read_settings(config, object);
}

// Throws UsageError for any option given beside those `allowed` ("--out"): OPTION + `why`.
void refuse_options_except(const CLI::App& app, const std::vector<std::string>& allowed,
                           const std::string& why);

// Throws UsageError for any of these `options` given: OPTION + `why`.
void refuse_options(const CLI::App& app, const std::vector<std::string>& options,
                    const std::string& why);

// --threads N. `help`: of a command whose threads each do a thing of their own.
template <class Integer>
void add_threads_option(CLI::App& app, Integer& threads,
                        const std::string& help = "threads, 0 for all cores") {
  app.add_option("--threads", threads, help)->check(CLI::Range(0, 1024))->capture_default_str();
}

// --device cpu|cuda|auto and --threads N.
void add_machine_options(CLI::App& app, std::string& device, int& threads);

// --json FILE, for the tables that are printed.
void add_json_option(CLI::App& app, std::string& file);

// Prints the table and, when `json_file` is not empty, writes its JSON there.
void print_table(const Table& table, const std::string& json_file);
// Several tables, as one JSON list.
void print_tables(const std::vector<Table>& tables, const std::string& json_file);

}  // namespace mocaplm
