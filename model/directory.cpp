#include "model/directory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.h"
#include "common/files.h"
#include "common/random.h"
#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

Json ints(const std::vector<std::int32_t>& values) {
  return Json(values);
}

std::vector<std::int32_t> read_ints(JsonObject& object, const std::string& key) {
  std::vector<std::int32_t> values;
  for (const double value : object.numbers(key)) {
    if (std::abs(value) > std::numeric_limits<std::int32_t>::max() || value != std::trunc(value))
      object.fail(key, "expected whole numbers, found " + format_number(value));
    values.push_back(static_cast<std::int32_t>(value));
  }
  return values;
}

Json self_test_json(const std::vector<SelfTestCase>& cases) {
  Json all = Json::array();
  for (const SelfTestCase& one : cases) {
    const ModelInput& in = one.input;
    all.push_back({{"token", ints(in.token)},
                   {"frame", ints(in.frame)},
                   {"channel", ints(in.channel)},
                   {"centre", ints(in.centre)},
                   {"surprise", ints(in.surprise)},
                   {"velocity", ints(in.velocity)},
                   {"last_surprise", ints(in.last_surprise)},
                   {"logits", one.logits}});
  }
  return all;
}

std::vector<SelfTestCase> read_self_test(const Json& json, const std::string& place) {
  if (!json.is_array()) throw DataError(in_file(place), "expected a list of cases");
  std::vector<SelfTestCase> cases;
  for (const Json& item : json) {
    JsonObject object(item, place);
    SelfTestCase one;
    ModelInput& in = one.input;
    in.token = read_ints(object, "token");
    in.frame = read_ints(object, "frame");
    in.channel = read_ints(object, "channel");
    in.centre = read_ints(object, "centre");
    in.surprise = read_ints(object, "surprise");
    in.velocity = read_ints(object, "velocity");
    in.last_surprise = read_ints(object, "last_surprise");
    for (const double value : object.numbers("logits"))
      one.logits.push_back(static_cast<float>(value));
    object.finish();
    for (const auto* list :
         {&in.frame, &in.channel, &in.centre, &in.surprise, &in.velocity, &in.last_surprise})
      if (list->size() != in.size()) throw DataError(in_file(place), "lists of different lengths");
    cases.push_back(std::move(one));
  }
  return cases;
}

void write_marker(const fs::path& directory) {
  Json files = Json::object();
  for (const auto& entry : fs::directory_iterator(directory)) {
    const std::string bytes = read_file(entry.path(), kMaxModelBytes);
    files[entry.path().filename().string()] = {{"bytes", bytes.size()},
                                               {"hash", hex(stable_hash(bytes))}};
  }
  save_json(directory / "complete", files);
}

// `contents`: also the hashes, which takes reading everything.
void check_marker(const fs::path& directory, bool contents) {
  const fs::path marker = directory / "complete";
  if (!fs::exists(marker))
    throw DataError(
        in_file(directory.string()),
        "has no file \"complete\": the model was never finished, or this is not a model");
  const Json files = load_json(marker);
  if (!files.is_object()) throw DataError(in_file(marker.string()), "expected a JSON object");
  for (const char* name : {"config.json", "model.safetensors", "selftest.json", "tokenizer.json"})
    if (!files.contains(name))
      throw DataError(in_file(marker.string()), std::string("does not list ") + name);
  for (const auto& item : files.items()) {
    JsonObject entry(item.value(), marker.string() + ": " + item.key());
    const fs::path file = directory / fs::path(item.key()).filename();
    const auto size = static_cast<std::uintmax_t>(entry.integer("bytes", 0));
    const std::string hash = entry.text("hash");
    entry.finish();
    std::error_code error;
    const std::uintmax_t found = fs::file_size(file, error);
    if (error) throw DataError(in_file(file.string()), "cannot be read: " + error.message());
    if (found != size)
      throw DataError(in_file(file.string()), "has " + std::to_string(found) + " bytes, expected " +
                                                  std::to_string(size) +
                                                  ": the file was cut off or changed");
    if (contents && hex(stable_hash(read_file(file, kMaxModelBytes))) != hash)
      throw DataError(in_file(file.string()),
                      "was changed after the model was saved (its hash differs)");
  }
}

// Before anybody makes room for the weights that the config asks for.
void check_size(const StoredModel& model, const fs::path& directory) {
  double held = 0;
  for (const auto& item : model.tensors) held += static_cast<double>(item.second.size());
  const double wanted = parameter_count(model.description);
  if (held < wanted)
    throw DataError(
        in_file((directory / "model.safetensors").string()),
        "holds " + format_number(held) + " values, config.json asks for " + format_number(wanted));
}

}  // namespace

fs::path resolve_model(const fs::path& path) {
  if (!fs::exists(path)) throw DataError(in_file(path.string()), "no such model folder");
  if (!fs::is_directory(path))
    throw DataError(in_file(path.string()), "is a file, expected a model folder");
  for (const fs::path& candidate : {path, path / "best", path / "last"})
    if (fs::exists(candidate / "config.json")) return candidate;
  throw DataError(
      in_file(path.string()),
      "holds no config.json, so it is neither a model nor a training run with one saved");
}

bool looks_like_model(const fs::path& path) {
  return fs::exists(path / "config.json") || fs::exists(path / "model.safetensors");
}

ModelDescription load_description(const fs::path& path) {
  const fs::path file = resolve_model(path) / "config.json";
  return model_from_json(load_json(file), file.string());
}

StoredModel load_model(const fs::path& path) {
  const fs::path directory = resolve_model(path);
  check_marker(directory, true);
  StoredModel model;
  model.description = load_description(directory);
  model.tokenizer = load_json(directory / "tokenizer.json");
  if (model.description.has_pieces()) model.pieces = read_file(directory / "pieces.model");
  model.tensors = read_safetensors(directory / "model.safetensors");
  check_size(model, directory);
  const fs::path test = directory / "selftest.json";
  model.self_test = read_self_test(load_json(test), test.string());
  return model;
}

TensorMap language_tensors(const TensorMap& tensors) {
  TensorMap own;
  for (const auto& [name, tensor] : tensors)
    if (name.rfind("class_", 0) != 0)
      own[name.rfind("transformer.", 0) == 0 ? name.substr(12) : name] = tensor;
  return own;
}

void check_input(const ModelInput& input, const ModelDescription& model, const std::string& place) {
  const ModelSizes sizes = model_sizes(model);
  const auto check = [&](const std::vector<std::int32_t>& values, std::int64_t rows,
                         const char* what) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] < 0 || values[i] >= rows)
        throw DataError(in_file(place), std::string(what) + " " + std::to_string(values[i]) +
                                            " at position " + std::to_string(i) +
                                            ", expected 0 to " + std::to_string(rows - 1));
  };
  const std::int64_t most = tokens_in_window(model);
  if (input.size() == 0 || static_cast<std::int64_t>(input.size()) > most)
    throw DataError(in_file(place), "a window of " + std::to_string(input.size()) +
                                        " tokens, expected 1 to " + std::to_string(most));
  const auto prefix = std::find_if(input.frame.begin(), input.frame.end(),
                                   [](std::int32_t frame) { return frame != 0; }) -
                      input.frame.begin();
  const std::int64_t frames =
      (static_cast<std::int64_t>(input.size()) - prefix) / model.shape.tokens_per_frame();
  if (prefix == 0 || (model.frame_positions() && prefix + frames > model.config.block_size))
    throw DataError(in_file(place), "a window with a prefix of " + std::to_string(prefix) +
                                        " tokens, expected 1 or more that fit the model's " +
                                        std::to_string(model.config.block_size) + " positions");
  check(input.token, model.shape.vocabulary, "token");
  check(input.frame, sizes.frame_positions, "frame");
  check(input.channel, sizes.channel_positions, "channel");
  check(input.surprise, sizes.history_rows, "surprise");
  check(input.velocity, sizes.history_rows, "velocity");
  check(input.last_surprise, sizes.history_rows, "last surprise");
}

namespace {

// Mean distance over the spread of what is expected: about 1 or more for other weights.
double relative_distance(const std::vector<float>& logits, const std::vector<float>& expected) {
  double mean = 0, spread = 0, distance = 0;
  for (const float value : expected) mean += value / static_cast<double>(expected.size());
  for (std::size_t i = 0; i < logits.size(); ++i) {
    spread += std::abs(expected[i] - mean);
    distance += std::abs(static_cast<double>(logits[i]) - expected[i]);
  }
  return distance / std::max(spread, 1e-3 * static_cast<double>(expected.size()));
}

}  // namespace

void check_self_test(const SelfTestCase& expected, const std::vector<float>& logits,
                     const std::string& place, double tolerance) {
  if (logits.size() != expected.logits.size())
    throw DataError(in_file(place), "expects " + std::to_string(expected.logits.size()) +
                                        " logits, the model gives " +
                                        std::to_string(logits.size()));
  const std::string rest = "; weights and config do not belong together";
  if (tolerance > 0) {
    const double distance = relative_distance(logits, expected.logits);
    if (!(distance <= tolerance))
      throw DataError(in_file(place), "the model's self-test fails: the logits are off by " +
                                          format_number(distance) + " of their spread" + rest);
    return;
  }
  for (std::size_t i = 0; i < logits.size(); ++i)
    if (!(std::abs(logits[i] - expected.logits[i]) <= 2e-2f + 1e-3f * std::abs(expected.logits[i])))
      throw DataError(in_file(place), "the model's self-test fails: logit " + std::to_string(i) +
                                          " is " + std::to_string(logits[i]) + ", expected " +
                                          std::to_string(expected.logits[i]) + rest);
}

void check_complete(const fs::path& path) {
  check_marker(resolve_model(path), false);
}

void save_model(const fs::path& path, const StoredModel& model,
                const std::function<void(const fs::path&)>& more) {
  write_directory_with(path, looks_like_model, [&](const fs::path& directory) {
    save_json(directory / "config.json", to_json(model.description));
    save_json(directory / "tokenizer.json", model.tokenizer);
    if (model.description.has_pieces()) write_file(directory / "pieces.model", model.pieces);
    write_file(directory / "selftest.json", self_test_json(model.self_test).dump() + "\n");
    write_safetensors(directory / "model.safetensors", model.tensors);
    if (more) more(directory);
    write_marker(directory);
  });
}

}  // namespace mocaplm
