#include "motion/dataset.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <set>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/npz.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr std::int64_t kMaxDatasetFrames = 100'000'000;
const char* const kFormat = "mocaplm dataset";

void check_name(const JsonObject& object, const std::string& name) {
  const bool odd = std::any_of(name.begin(), name.end(),
                               [](unsigned char c) { return c < 32 || c == 127 || c == '/'; });
  if (name.empty() || name[0] == '.' || odd || name.size() > 200)
    object.fail("name",
                "\"" + name + "\" is not a clip name: 1 to 200 characters, no '/', no leading '.'");
}

// A dataset may come from anywhere: its files must lie inside it, links included.
void check_file(const JsonObject& object, const fs::path& directory, const std::string& file) {
  const fs::path path(file);
  bool inside = !path.empty() && path.is_relative();
  for (const fs::path& part : path) inside = inside && part != "..";
  std::error_code error;
  const fs::path root = fs::weakly_canonical(directory, error);
  const fs::path real = fs::weakly_canonical(directory / path, error);
  const auto end = std::mismatch(root.begin(), root.end(), real.begin(), real.end());
  if (!inside || error || end.first != root.end())
    object.fail("file",
                "\"" + file + "\" leaves the dataset's directory, expected a path inside it");
}

Labels read_labels(JsonObject object) {
  Labels labels;
  for (const std::string& key : object.keys()) labels[key] = object.text(key);
  return labels;
}

DatasetEntry read_entry(JsonObject object, const fs::path& directory) {
  DatasetEntry entry;
  entry.name = object.text("name");
  check_name(object, entry.name);
  entry.file = object.text("file");
  check_file(object, directory, entry.file);
  entry.frames = object.integer("frames", 1, kMaxDatasetFrames);
  entry.fps = object.number("fps", 0, 10000);
  if (entry.fps <= 0) object.fail("fps", "expected more than 0 frames per second");
  entry.labels = read_labels(object.object("labels"));
  entry.group = object.text("group");
  entry.split = object.choice("split", split_names());
  entry.source = object.text("source");
  object.finish();
  return entry;
}

Json entry_json(const DatasetEntry& entry) {
  return Json{{"name", entry.name},   {"file", entry.file},     {"frames", entry.frames},
              {"fps", entry.fps},     {"labels", entry.labels}, {"group", entry.group},
              {"split", entry.split}, {"source", entry.source}};
}

// One clip a line: a thousand clips stay readable and comparable line by line.
std::string dataset_text(const Dataset& dataset) {
  const auto dump = [](const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
  };
  const Json head{{"format", kFormat},
                  {"version", dataset.version},
                  {"procedural", dataset.procedural},
                  {"import", dataset.import}};
  std::string text = dump(head, 2);
  text.erase(text.rfind('\n'));
  text += ",\n  \"clips\": [";
  const char* between = "\n    ";
  for (const DatasetEntry& entry : dataset.entries) {
    text += between + dump(entry_json(entry), -1);
    between = ",\n    ";
  }
  return text + "\n  ]\n}\n";
}

void sort_and_check(Dataset& dataset, const std::string& place) {
  std::sort(dataset.entries.begin(), dataset.entries.end(),
            [](const DatasetEntry& a, const DatasetEntry& b) { return a.name < b.name; });
  std::set<std::string> files;
  for (std::size_t i = 0; i < dataset.entries.size(); ++i) {
    if (i > 0 && dataset.entries[i].name == dataset.entries[i - 1].name)
      throw DataError(in_file(place),
                      "lists the clip \"" + dataset.entries[i].name + "\" more than once");
    if (!files.insert(fs::path(dataset.entries[i].file).lexically_normal().string()).second)
      throw DataError(in_file(place),
                      "lists the file \"" + dataset.entries[i].file + "\" more than once");
  }
}

}  // namespace

const std::vector<std::string>& split_names() {
  static const std::vector<std::string> names = {"train", "validation", "test"};
  return names;
}

const DatasetEntry* Dataset::find(const std::string& name) const {
  const auto at = std::lower_bound(
      entries.begin(), entries.end(), name,
      [](const DatasetEntry& entry, const std::string& wanted) { return entry.name < wanted; });
  return at != entries.end() && at->name == name ? &*at : nullptr;
}

std::vector<DatasetEntry> Dataset::split(const std::string& name) const {
  std::vector<DatasetEntry> chosen;
  for (const DatasetEntry& entry : entries)
    if (entry.split == name) chosen.push_back(entry);
  return chosen;
}

std::vector<std::string> Dataset::label_values(const std::string& label) const {
  std::set<std::string> values;
  for (const DatasetEntry& entry : entries) {
    const auto found = entry.labels.find(label);
    if (found != entry.labels.end()) values.insert(found->second);
  }
  return {values.begin(), values.end()};
}

std::vector<std::string> Dataset::label_names() const {
  std::set<std::string> names;
  for (const DatasetEntry& entry : entries)
    for (const auto& [name, value] : entry.labels) names.insert(name);
  return {names.begin(), names.end()};
}

std::string dataset_trouble(const Dataset& dataset) {
  if (dataset.version >= 2 || dataset.procedural) return "";
  const auto up = dataset.import.find("up");
  const std::string given =
      up != dataset.import.end() && up->is_string() ? up->get<std::string>() : "auto";
  std::size_t affected = 0;
  for (const DatasetEntry& entry : dataset.entries) {
    const std::string extension = lower(fs::path(entry.source).extension().string());
    affected += (extension == ".npz" && given != "y") || (extension == ".pkl" && given == "z");
  }
  if (affected == 0) return "";
  return dataset.directory.string() + ": " + std::to_string(affected) + " of " +
         std::to_string(dataset.entries.size()) +
         " clips come from .npz or .pkl files and were imported by an older version, which put "
         "those "
         "with Z up (AMASS) 25 cm too low and 20 cm aside: import them again";
}

Dataset load_dataset(const fs::path& directory) {
  Dataset dataset = read_dataset(directory);
  const std::string trouble = dataset_trouble(dataset);
  static std::mutex mutex;
  static std::set<std::string> said;
  const std::lock_guard<std::mutex> lock(mutex);
  if (!trouble.empty() && said.insert(trouble).second)
    std::fprintf(stderr, "note: %s\n", trouble.c_str());
  return dataset;
}

Dataset read_dataset(const fs::path& directory) {
  if (!fs::is_directory(directory))
    throw DataError(in_file(directory.string()), fs::exists(directory)
                                                     ? "is a file, expected a dataset directory"
                                                     : "no such dataset directory");
  const fs::path path = directory / "dataset.json";
  if (!fs::exists(path))
    throw DataError(in_file(directory.string()),
                    "has no dataset.json, so it is not a dataset; make one with 'mocaplm import'");
  const std::string place = path.string();
  JsonObject object(load_json(path), place);
  if (object.text("format") != kFormat)
    object.fail("format", std::string("expected \"") + kFormat + "\"");
  Dataset dataset;
  dataset.version = object.integer("version", 1, kDatasetVersion);
  dataset.directory = directory;
  dataset.procedural = object.boolean("procedural");
  dataset.import = object.raw("import");
  const Json& clips = object.raw("clips");
  if (!clips.is_array()) object.fail("clips", "expected a list of clips");
  for (std::size_t i = 0; i < clips.size(); ++i)
    dataset.entries.push_back(
        read_entry(JsonObject(clips[i], place + ": clip " + std::to_string(i + 1)), directory));
  object.finish();
  sort_and_check(dataset, place);
  return dataset;
}

void save_dataset(const Dataset& dataset) {
  Dataset sorted = dataset;
  const fs::path path = dataset.directory / "dataset.json";
  sort_and_check(sorted, path.string());
  write_file(path, dataset_text(sorted));
}

bool is_dataset(const fs::path& directory) {
  std::error_code ignored;
  return fs::exists(directory / "dataset.json", ignored);
}

Clip load_clip(const Dataset& dataset, const DatasetEntry& entry) {
  const fs::path path = dataset.directory / entry.file;
  Clip clip = read_npz(path, UpAxis::y);
  if (clip.frames() != entry.frames)
    throw DataError(in_file(path.string()), "has " + std::to_string(clip.frames()) +
                                                " frames, but dataset.json says " +
                                                std::to_string(entry.frames));
  if (std::abs(clip.fps - entry.fps) > 1e-6 * entry.fps)
    throw DataError(in_file(path.string()), "runs at " + format_number(clip.fps) +
                                                " frames per second, but dataset.json says " +
                                                format_number(entry.fps));
  clip.name = entry.name;
  clip.labels = entry.labels;
  return clip;
}

}  // namespace mocaplm
