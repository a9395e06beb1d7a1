#include "motion/inputs.h"

#include <map>
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

// "_1.5-3.6" of "walk:1.5-3.6", where `whole` is "walk".
std::string range_suffix(const std::string& whole, const std::string& text) {
  return text.size() > whole.size() ? "_" + text.substr(whole.size() + 1) : "";
}

// Finds the inputs in their order; a folder is loaded once.
class InputFinder {
 public:
  explicit InputFinder(const std::vector<std::string>& clips) : clips_(clips) {}

  void add(const std::string& input) {
    if (fs::is_directory(input)) return add_folder(input);
    const std::string whole = parse_clip_range(input).clip;
    PartName name = split_part(whole);
    if (!name.part.empty() && fs::is_directory(name.file))
      return add_clip(name.file, input.substr(name.file.size() + 1));
    std::error_code unknown;  // other troubles are those of reading
    if (fs::status(name.file, unknown).type() == fs::file_type::not_found)
      throw DataError(in_file(name.file), "no such file");
    const std::string part = name.part.empty() ? "" : "_" + name.part;
    found_.push_back(
        {input, fs::path(name.file).stem().string() + part + range_suffix(whole, input), nullptr});
  }

  std::vector<MotionInput> found() {
    for (const std::string& clip : clips_)
      if (used_.count(clip) == 0) refuse(clip, known_);
    return std::move(found_);
  }

 private:
  std::shared_ptr<const Dataset> load(const std::string& folder) {
    std::shared_ptr<const Dataset>& dataset = datasets_[folder];
    if (!dataset) dataset = std::make_shared<const Dataset>(load_dataset(folder));
    return dataset;
  }

  void take(const std::shared_ptr<const Dataset>& dataset, const DatasetEntry& entry,
            const std::string& text) {
    found_.push_back({text, entry.name + range_suffix(entry.name, text), dataset});
  }

  void add_folder(const std::string& folder) {
    const auto dataset = load(folder);
    for (const DatasetEntry& entry : dataset->entries) {
      known_.push_back(entry.name);
      if (clips_.empty()) take(dataset, entry, entry.name);
    }
    for (const std::string& clip : clips_)
      if (const DatasetEntry* entry = find_entry(*dataset, clip)) {
        take(dataset, *entry, clip);
        used_.insert(clip);
      }
  }

  void add_clip(const std::string& folder, const std::string& clip) {
    const auto dataset = load(folder);
    const DatasetEntry* entry = find_entry(*dataset, clip);
    if (entry != nullptr) return take(dataset, *entry, clip);
    std::vector<std::string> names;
    for (const DatasetEntry& one : dataset->entries) names.push_back(one.name);
    throw UsageError("no clip of " + folder + " is named \"" + clip + "\"" +
                     did_you_mean(clip, names));
  }

  [[noreturn]] static void refuse(const std::string& clip, const std::vector<std::string>& known) {
    throw UsageError(
        "no clip is named \"" + clip + "\"" + did_you_mean(clip, known) +
        (known.empty() ? ": --clip chooses from dataset folders, none was given" : ""));
  }

  const std::vector<std::string>& clips_;
  std::map<std::string, std::shared_ptr<const Dataset>> datasets_;
  std::vector<MotionInput> found_;
  std::set<std::string> used_;
  std::vector<std::string> known_;
};

}  // namespace

const DatasetEntry* MotionInput::entry() const {
  return dataset ? find_entry(*dataset, text) : nullptr;
}

fs::path MotionInput::file() const {
  if (!dataset) return split_part(parse_clip_range(text).clip).file;
  return dataset->directory / entry()->file;
}

std::vector<MotionInput> find_motions(const std::vector<std::string>& inputs,
                                      const std::vector<std::string>& clips,
                                      const MotionReading& reading) {
  InputFinder finder(clips);
  for (const std::string& input : inputs) finder.add(input);
  std::vector<MotionInput> found = finder.found();
  bool files = false;
  for (const MotionInput& input : found) files = files || !input.dataset;
  if (!files)
    refuse_read_options(reading,
                        " has no effect: the clips of a dataset were read when it was imported, "
                        "and no motion file is given");
  return found;
}

MotionInput find_motion(const std::string& input, const MotionReading& reading) {
  const std::vector<MotionInput> found = find_motions({input}, {}, reading);
  if (found.empty()) throw UsageError(input + " holds no clips");
  if (found.size() > 1)
    throw UsageError(input + " holds " + std::to_string(found.size()) +
                     " clips, expected one: name it as " + input + "#" + found.front().text);
  return found.front();
}

std::vector<fs::path> files_of(const std::vector<MotionInput>& inputs) {
  std::vector<fs::path> files;
  for (const MotionInput& input : inputs) files.push_back(input.file());
  return files;
}

RangedClip read_motion(const MotionInput& input, const MotionReading& reading) {
  return read_clip_range(input.text, input.dataset.get(), reading);
}

std::vector<NamedMotion> read_motions(const MotionInput& input, const MotionReading& reading) {
  std::vector<RangedClip> clips = read_clip_ranges(input.text, input.dataset.get(), reading);
  std::vector<NamedMotion> motions;
  if (clips.size() == 1) {
    motions.push_back({input.text, input.name, std::move(clips.front())});
    return motions;
  }
  const std::string whole = parse_clip_range(input.text).clip;
  const std::string range = input.text.substr(whole.size()), stem = input.file().stem().string();
  for (RangedClip& clip : clips) {
    const std::string name = clip.clip.name;
    const bool named = name.compare(0, stem.size() + 1, stem + "_") == 0;
    const std::string part = named ? name.substr(stem.size() + 1) : name;
    motions.push_back(
        {whole + "#" + part + range, name + range_suffix(whole, input.text), std::move(clip)});
  }
  return motions;
}

std::vector<MotionInput> parts_of(const MotionInput& input, const MotionReading& reading) {
  // A dataset's clip is one, and the .bvh of one skeleton.
  if (input.dataset || lower(input.file().extension().string()) == ".bvh") return {input};
  std::vector<MotionInput> parts;
  for (const NamedMotion& motion : read_motions(input, reading))
    parts.push_back({motion.text, motion.name, nullptr});
  return parts;
}

Clip read_one_motion(const std::string& text, const MotionReading& reading) {
  return read_motion(find_motion(text, reading), reading).clip;
}

}  // namespace mocaplm
