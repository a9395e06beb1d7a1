#include "train/config.h"

namespace mocaplm {

namespace {

template <class Section>
void read_section(JsonObject& top, const char* key, Section& section) {
  if (!top.has(key)) return;
  JsonObject object = top.object(key);
  read_settings(section, object);
  object.finish();
}

}  // namespace

RunConfig run_config_from_json(const Json& json, const std::string& place) {
  RunConfig config;
  JsonObject top(json, place);
  read_section(top, "tokenizer", config.tokenizer);
  read_section(top, "pieces", config.pieces);
  read_section(top, "model", config.model);
  read_section(top, "train", config.train);
  top.finish();
  return config;
}

RunConfig load_run_config(const std::filesystem::path& path) {
  return run_config_from_json(load_json(path), path.string());
}

Json to_json(const RunConfig& config) {
  return {{"tokenizer", settings_json(config.tokenizer)},
          {"pieces", settings_json(config.pieces)},
          {"model", settings_json(config.model)},
          {"train", settings_json(config.train)}};
}

}  // namespace mocaplm
