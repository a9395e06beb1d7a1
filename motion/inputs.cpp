#include "motion/inputs.h"

#include <set>

#include "common/error.h"
#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

const DatasetEntry* find_entry(const Dataset& dataset, const std::string& text) {
  const DatasetEntry* whole = dataset.find(text);
  return whole != nullptr ? whole : dataset.find(parse_clip_range(text).clip);
}

// "walk" and what follows it in "walk:1.5-3.6".
std::string part_name(const std::string& stem, const std::string& whole, const std::string& text) {
  return text.size() > whole.size() ? stem + "_" + text.substr(whole.size() + 1) : stem;
}

}  // namespace

fs::path MotionInput::file() const {
  if (!dataset) return parse_clip_range(text).clip;
  return dataset->directory / find_entry(*dataset, text)->file;
}

std::vector<MotionInput> find_motions(const std::vector<std::string>& inputs,
                                      const std::vector<std::string>& clips) {
  std::vector<MotionInput> found;
  std::set<std::string> used;
  std::vector<std::string> known;
  for (const std::string& input : inputs) {
    if (!fs::is_directory(input)) {
      const std::string file = parse_clip_range(input).clip;
      std::error_code unknown;  // other troubles are those of reading
      if (fs::status(file, unknown).type() == fs::file_type::not_found)
        throw DataError(in_file(file), "no such file");
      found.push_back({input, part_name(fs::path(file).stem().string(), file, input), nullptr});
      continue;
    }
    const auto dataset = std::make_shared<const Dataset>(load_dataset(input));
    for (const DatasetEntry& entry : dataset->entries) {
      known.push_back(entry.name);
      if (clips.empty()) found.push_back({entry.name, entry.name, dataset});
    }
    for (const std::string& clip : clips)
      if (const DatasetEntry* entry = find_entry(*dataset, clip)) {
        found.push_back({clip, part_name(entry->name, entry->name, clip), dataset});
        used.insert(clip);
      }
  }
  for (const std::string& clip : clips)
    if (used.count(clip) == 0)
      throw UsageError(
          "no clip is named \"" + clip + "\"" + did_you_mean(clip, known) +
          (known.empty() ? ": --clip chooses from dataset folders, none was given" : ""));
  return found;
}

std::vector<fs::path> files_of(const std::vector<MotionInput>& inputs) {
  std::vector<fs::path> files;
  for (const MotionInput& input : inputs) files.push_back(input.file());
  return files;
}

RangedClip read_motion(const MotionInput& input, const ReadOptions& options) {
  return read_clip_range(input.text, input.dataset.get(), options);
}

}  // namespace mocaplm
