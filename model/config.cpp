#include "model/config.h"

#include "common/error.h"

namespace mocaplm {

namespace {
constexpr std::int64_t kFormat = 1;
}

void check_model(const ModelDescription& d) {
  const ModelConfig& c = d.config;
  if (c.n_embd % c.n_head != 0)
    throw UsageError("n_head (" + std::to_string(c.n_head) + ") must divide n_embd (" +
                     std::to_string(c.n_embd) + ")");
  const std::int64_t need = 1 + static_cast<std::int64_t>(d.conditions.size() + d.classes.size()) +
                            2 * d.shape.tokens_per_frame();
  if (c.block_size < need)
    throw UsageError("block_size " + std::to_string(c.block_size) +
                     " is too small: two frames and the condition tokens need " +
                     std::to_string(need));
}

Json to_json(const ModelDescription& d) {
  Json json{{"format", kFormat}, {"model", settings_json(d.config)}};
  json["stream"] = {{"vocabulary", d.shape.vocabulary},
                    {"first_bin", d.shape.first_bin},
                    {"bins", d.shape.bins},
                    {"channels", d.shape.channels}};
  json["tokenizer_fingerprint"] = d.tokenizer_fingerprint;
  json["conditions"] = d.conditions;
  json["classes"] = Json::array();
  for (const auto& [label, values] : d.classes)
    json["classes"].push_back({{"label", label}, {"values", values}});
  json["procedural"] = d.procedural;
  json["training"] = d.training;
  return json;
}

ModelDescription model_from_json(const Json& json, const std::string& place) {
  ModelDescription d;
  JsonObject top(json, place);
  top.integer("format", kFormat, kFormat);
  JsonObject model = top.object("model");
  read_settings(d.config, model);
  model.finish();
  JsonObject stream = top.object("stream");
  d.shape.bins = stream.integer("bins", 2, 4096);
  d.shape.channels = stream.integer("channels", 1, 1000);
  d.shape.first_bin = stream.integer("first_bin", 1, 1000);
  d.shape.vocabulary = stream.integer("vocabulary", d.shape.first_bin + d.shape.bins, 100000);
  stream.finish();
  d.tokenizer_fingerprint = top.text("tokenizer_fingerprint");
  d.conditions = top.texts("conditions");
  const Json& classes = top.raw("classes");
  if (!classes.is_array()) top.fail("classes", "expected a list, found " + classes.dump());
  for (const Json& item : classes) {
    JsonObject one(item, place + ": \"classes\"");
    const std::string label = one.text("label");
    d.classes.emplace_back(label, one.texts("values"));
    one.finish();
  }
  d.procedural = top.boolean("procedural");
  d.training = top.raw("training");
  top.finish();
  try {
    check_model(d);
  } catch (const UsageError& error) {
    throw DataError(in_file(place), error.what());
  }
  return d;
}

ModelSizes model_sizes(const ModelDescription& d) {
  const ModelConfig& c = d.config;
  return {c.block_size / d.shape.tokens_per_frame() + 3, d.shape.channels + 2, 2 * c.reach + 2,
          2 * c.reach + 1};
}

double parameter_count(const ModelDescription& d) {
  const ModelConfig& c = d.config;
  const ModelSizes sizes = model_sizes(d);
  const auto width = static_cast<double>(c.n_embd),
             vocabulary = static_cast<double>(d.shape.vocabulary);
  double rows =
      vocabulary + 2;  // token embedding and the last layer norm, then what is beside them
  rows += static_cast<double>(
      c.position == "custom" ? sizes.frame_positions + sizes.channel_positions : c.block_size);
  if (c.history) rows += 3 * static_cast<double>(sizes.history_rows);
  rows += static_cast<double>(c.n_layer) * (12 * width + 13);
  double outputs = vocabulary;
  if (c.output == "extrapolation") outputs += static_cast<double>(sizes.offsets);
  return rows * width + outputs * (width + 1);
}

}  // namespace mocaplm
