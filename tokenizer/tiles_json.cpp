// The tile tokenizer's tokenizer.json: settings, components, bins and a fingerprint of all of them.
#include <cstdio>

#include "common/error.h"
#include "common/random.h"
#include "common/settings.h"
#include "tokenizer/tiles.h"

namespace mocaplm {

namespace {

constexpr std::int64_t kTilesVersion = 1;

std::vector<double> flat(const Eigen::MatrixXd& matrix) {
  std::vector<double> numbers;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) numbers.push_back(matrix(r, c));
  return numbers;
}

// Row after row.
Eigen::MatrixXd matrix(JsonObject& object, const std::string& key, Eigen::Index rows,
                       Eigen::Index cols) {
  const std::vector<double> numbers = object.numbers(key);
  if (static_cast<Eigen::Index>(numbers.size()) != rows * cols)
    object.fail(key, "expected " + std::to_string(rows) + " rows of " + std::to_string(cols) +
                         " numbers, found " + std::to_string(numbers.size()) + " numbers");
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      numbers.data(), rows, cols);
}

Components read_components(JsonObject object, Eigen::Index channels, Eigen::Index most) {
  Components basis;
  const std::int64_t count = object.integer("count", 1, channels);
  if (most > 0 && count > most) object.fail("count", "is more than the settings ask for");
  basis.mean = matrix(object, "mean", 1, channels);
  if (most == 0) {
    if (count != channels) object.fail("count", "expected all " + std::to_string(channels));
    basis.analysis = basis.synthesis = Eigen::MatrixXd::Identity(channels, channels);
  } else {
    basis.analysis = matrix(object, "analysis", channels, count);
    basis.synthesis = matrix(object, "synthesis", count, channels);
  }
  object.finish();
  return basis;
}

// Throws unless every setting is there: defaults of another version must not change a file.
template <class Config>
void require_all(JsonObject& object, const Config& config) {
  const Json all = settings_json(config);  // items() only points into it
  for (const auto& item : all.items()) object.raw(item.key());
}

void append_exact(std::string& text, const Eigen::MatrixXd& matrix) {
  char buffer[32];
  for (const double number : flat(matrix)) {
    std::snprintf(buffer, sizeof buffer, " %.17g", number);
    text += buffer;
  }
}

}  // namespace

std::string TileTokenizer::fingerprint() const {
  std::string all = std::string(kFormat) + " version " + std::to_string(kTilesVersion) + " " +
                    settings_json(frames_).dump() + settings_json(tiles_).dump();
  append_exact(all, basis_.mean);
  append_exact(all, basis_.analysis);
  append_exact(all, basis_.synthesis);
  for (const Bins& bins : fitted_) all += " " + bins.exact_text();
  return hex(stable_hash(all));
}

Json TileTokenizer::to_json() const {
  Json json;
  json["format"] = kFormat;
  json["version"] = kTilesVersion;
  json["settings"] = settings_json(frames_);
  json["tiles"] = settings_json(tiles_);
  Json& basis = json["components"];
  basis["count"] = components();
  basis["mean"] = flat(basis_.mean);
  if (tiles_.pca > 0 || tiles_.ica > 0) {
    basis["analysis"] = flat(basis_.analysis);
    basis["synthesis"] = flat(basis_.synthesis);
  }
  json["bins"] = Json::array();
  for (const Bins& bins : fitted_) json["bins"].push_back(bins.to_json());
  json["fingerprint"] = fingerprint();
  return json;
}

TileTokenizer TileTokenizer::from_json(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  object.choice("format", {kFormat});
  object.integer("version", kTilesVersion, kTilesVersion);
  TokenizerConfig frames;
  JsonObject settings = object.object("settings");
  require_all(settings, frames);
  read_settings(frames, settings);
  settings.finish();
  TileConfig tiles;
  JsonObject tile_settings = object.object("tiles");
  require_all(tile_settings, tiles);
  read_settings(tiles, tile_settings);
  tile_settings.finish();
  try {
    TileTokenizer tokenizer(frames, tiles);
    tokenizer.basis_ = read_components(object.object("components"), tokenizer.channels(),
                                       std::max(tiles.pca, tiles.ica));
    tokenizer.make_transforms();
    const Json& bins = object.raw("bins");
    const bool pooled = frames.binning != "quantile";
    const std::size_t sets = pooled ? 1 : static_cast<std::size_t>(tokenizer.components());
    if (!bins.is_array() || bins.size() != sets)
      object.fail("bins", "expected a list of " + std::to_string(sets) + " sets of bins");
    for (std::size_t i = 0; i < sets; ++i)
      tokenizer.fitted_.push_back(
          Bins::from_json(bins[i], place + ": bins " + std::to_string(i), tokenizer.bins()));
    const std::string found = object.text("fingerprint");
    if (found != tokenizer.fingerprint())
      object.fail("fingerprint", "is " + found + ", but the rest gives " + tokenizer.fingerprint() +
                                     ": the file was changed by hand or damaged");
    object.finish();
    return tokenizer;
  } catch (const UsageError& error) {
    object.fail("settings", error.what());
  }
}

}  // namespace mocaplm
