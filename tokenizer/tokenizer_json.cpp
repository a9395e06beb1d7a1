// tokenizer.json: settings, the root's ranges, fitted bins, the condition tokens, and a fingerprint
// of what bins mean.
#include <cstdio>

#include "common/error.h"
#include "common/random.h"
#include "common/settings.h"
#include "motion/skeleton.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

namespace {

constexpr const char* kTokenizerFormat = "mocaplm tokenizer";
constexpr std::int64_t kTokenizerVersion = 1;
constexpr std::size_t kMaxLabelValues = 1 << 20;

std::string exact(double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

// "root.left" -> "left": the key under "root_ranges".
std::string range_key(const std::string& channel) {
  return channel.substr(channel.find('.') + 1);
}

}  // namespace

std::string Tokenizer::fingerprint() const {
  std::string all = "version " + std::to_string(kTokenizerVersion) + " bins " +
                    std::to_string(bins()) + " fps " + exact(config_.fps);
  for (int c = 0; c < channels(); ++c) {
    const auto i = static_cast<std::size_t>(c);
    all += " " + channel_name(c) + " " + exact(low_[i]) + " " + exact(high_[i]);
  }
  // Uniform tokenizers keep the fingerprint that they had before there were others.
  if (!fitted_.empty()) all += " binning " + config_.binning;
  for (const Bins& bins : fitted_) all += " " + bins.exact_text();
  return hex(stable_hash(all));
}

std::string Tokenizer::fitted_name(std::size_t index) const {
  if (!pooled_) return channel_name(static_cast<int>(index));
  return index == 0 ? "rotations" : channel_name(rotation_channels() + static_cast<int>(index) - 1);
}

Json Tokenizer::to_json() const {
  Json json;
  json["format"] = kTokenizerFormat;
  json["version"] = kTokenizerVersion;
  json["settings"] = settings_json(config_);
  if (fitted_.empty()) json["settings"].erase("binning");  // as it was before there was a choice
  Json ranges = Json::object();
  for (int c = rotation_channels(); c < channels(); ++c)
    ranges[range_key(channel_name(c))] = {low_[static_cast<std::size_t>(c)],
                                          high_[static_cast<std::size_t>(c)]};
  json["root_ranges"] = ranges;
  for (std::size_t i = 0; i < fitted_.size(); ++i)
    json["quantile_bins"][fitted_name(i)] = fitted_[i].to_json();
  Json labels = Json::array();
  for (const auto& [label, values] : labels_)
    labels.push_back({{"label", label}, {"values", values}});
  json["labels"] = labels;
  json["fingerprint"] = fingerprint();
  return json;
}

Tokenizer Tokenizer::of_model(const Json& json, const std::string& fingerprint,
                              const std::string& folder) {
  Tokenizer tokenizer = from_json(json, folder + "/tokenizer.json");
  if (tokenizer.fingerprint() != fingerprint)
    throw DataError(in_file(folder),
                    "tokenizer.json is not the tokenizer that this model was trained with "
                    "(fingerprint " +
                        tokenizer.fingerprint() + ", expected " + fingerprint + ")");
  return tokenizer;
}

Tokenizer Tokenizer::from_json(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  object.choice("format", {kTokenizerFormat});
  const std::int64_t version = object.integer("version", 1);
  if (version != kTokenizerVersion)
    object.fail("version", "is " + std::to_string(version) + ", this program reads version " +
                               std::to_string(kTokenizerVersion));

  TokenizerConfig config;
  config.root = "none";
  JsonObject settings = object.object("settings");
  for (const char* key : {"bins", "fps", "joints", "root"})
    settings.raw(key);  // none may be missing
  read_settings(config, settings);
  settings.finish();
  Tokenizer tokenizer;
  try {
    TokenizerConfig rotations = config;
    rotations.root = "none";  // the ranges come from the file, fitted bins too
    rotations.binning = "uniform";
    tokenizer = fit(rotations, {});
  } catch (const UsageError& error) {
    settings.fail("joints", error.what());
  }
  tokenizer.config_.root = config.root;
  tokenizer.config_.binning = config.binning;
  tokenizer.read_ranges(object);
  if (config.binning != "uniform") tokenizer.read_bins(object);
  tokenizer.read_labels(object);
  const std::string found = object.text("fingerprint");
  if (found != tokenizer.fingerprint())
    object.fail("fingerprint", "is " + found + ", but the settings and ranges give " +
                                   tokenizer.fingerprint() +
                                   ": the file was changed by hand or damaged");
  object.finish();
  return tokenizer;
}

void Tokenizer::read_ranges(JsonObject& object) {
  JsonObject ranges = object.object("root_ranges");
  if (config_.root != "none") {
    const auto rotations = static_cast<std::size_t>(rotation_channels());
    low_.resize(rotations + 3);
    high_.resize(rotations + 3);
    for (std::size_t c = rotations; c < rotations + 3; ++c) {
      const std::string key = range_key(channel_name(static_cast<int>(c)));
      const std::vector<double> range = ranges.numbers(key);
      if (range.size() != 2 || !(range[0] < range[1]) || range[0] < -1e6 || range[1] > 1e6)
        ranges.fail(
            key, "expected [low, high] in metres, low below high, found " + ranges.raw(key).dump());
      low_[c] = range[0];
      high_[c] = range[1];
    }
  }
  ranges.finish();
}

void Tokenizer::read_bins(JsonObject& object) {
  pooled_ = config_.binning == "pooled_quantile";
  const int sets = pooled_ ? channels() - rotation_channels() + 1 : channels();
  JsonObject all = object.object("quantile_bins");
  for (std::size_t i = 0; i < static_cast<std::size_t>(sets); ++i) {
    const std::string name = fitted_name(i);
    fitted_.push_back(Bins::from_json(all.raw(name), all.place() + ": \"" + name + "\"", bins()));
  }
  all.finish();
}

void Tokenizer::read_labels(JsonObject& object) {
  const Json& labels = object.raw("labels");
  if (!labels.is_array())
    object.fail("labels", std::string("expected a list, found ") + labels.type_name());
  std::size_t count = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    JsonObject label(labels[i], object.place() + ": \"labels\"[" + std::to_string(i) + "]");
    const std::string name = label.text("label");
    const std::vector<std::string> values = label.texts("values");
    label.finish();
    if (name.empty() || values.empty())
      label.fail("values", "expected a label with at least one value");
    if ((count += values.size()) > kMaxLabelValues) label.fail("values", "too many label values");
    // As written, in blocks: ids must come out the same.
    labels_.push_back({name, {}});
    std::set<std::string> seen;
    for (const auto& [other, known] : labels_)
      if (other == name) seen.insert(known.begin(), known.end());
    for (const std::string& value : values) {
      if (value.empty() || !seen.insert(value).second)
        label.fail("values", "\"" + value + "\" is empty or there twice");
      labels_.back().second.push_back(value);
    }
  }
}

void Tokenizer::save(const std::filesystem::path& path) const {
  save_json(path, to_json());
}

Tokenizer Tokenizer::load(const std::filesystem::path& path) {
  return from_json(load_json(path), path.string());
}

}  // namespace mocaplm
