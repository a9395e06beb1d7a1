// A dataset: a directory of clips (clips/NAME.npz) and a readable dataset.json that lists them:
//
//   {"format": "mocaplm dataset", "version": 2, "procedural": false,
//    "import": {...how it was made...},
//    "clips": [{"name": "walk", "file": "clips/walk.npz", "frames": 128, "fps": 30,
//               "labels": {"style": "happy"}, "group": "walk", "split": "train", "source": "..."}]}
//
// The version says what the readers did. Before version 2 files with Z up (AMASS) came in with the
// pelvis 25 cm too low and 20 cm aside.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/json.h"
#include "motion/clip.h"

namespace mocaplm {

struct DatasetEntry {
  std::string name;         // unique, also the file's stem
  std::string file;         // relative to the dataset's directory
  std::int64_t frames = 0;  // 1 or more
  double fps = 0;           // frames per second, in (0, 10000]
  Labels labels;
  std::string group;   // clips of one group are never separated by a split
  std::string split;   // "train", "validation" or "test"
  std::string source;  // where it was imported from

  double seconds() const { return fps > 0 ? static_cast<double>(frames) / fps : 0; }
};

constexpr std::int64_t kDatasetVersion = 2;

struct Dataset {
  std::filesystem::path directory;
  std::int64_t version = kDatasetVersion;  // the oldest reader among those of its clips
  std::vector<DatasetEntry> entries;       // sorted by name
  bool procedural = false;                 // made by `synth`: said wherever its motion is shown
  Json import = Json::object();            // the resolved settings of the command that made it

  // The clip of this name, or null.
  const DatasetEntry* find(const std::string& name) const;
  std::vector<DatasetEntry> split(const std::string& name) const;
  // Values of one label over all entries, sorted, each once.
  std::vector<std::string> label_values(const std::string& label) const;
  // Label names in use, sorted.
  std::vector<std::string> label_names() const;
};

// "train", "validation", "test".
const std::vector<std::string>& split_names();

// What is wrong with an older dataset, as a sentence without a full stop; "" when nothing is known.
std::string dataset_trouble(const Dataset& dataset);

// Reads and checks dataset.json. Throws DataError (missing keys, files that escape the directory,
// duplicate names, unknown splits).
Dataset read_dataset(const std::filesystem::path& directory);
// The same for whoever uses the clips: says dataset_trouble on stderr, once for each folder.
Dataset load_dataset(const std::filesystem::path& directory);
void save_dataset(const Dataset& dataset);
// Whether `directory` holds a dataset.json, sound or not.
bool is_dataset(const std::filesystem::path& directory);
// Reads one clip and gives it the entry's name and labels; throws DataError when it does not match
// it.
Clip load_clip(const Dataset& dataset, const DatasetEntry& entry);

}  // namespace mocaplm
