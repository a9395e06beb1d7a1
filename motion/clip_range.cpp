#include "motion/clip_range.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "common/error.h"
#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

double seconds_of(const std::string& digits, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(digits.c_str(), &end);
  if (digits.empty() || *end != 0 || !std::isfinite(value))
    throw UsageError("\"" + text + "\": \"" + digits +
                     "\" is no number of seconds; a part is FROM-TO, or FROM- up to the end");
  return value;
}

bool is_there(const std::string& path) {
  std::error_code unknown;  // other troubles are those of reading
  return fs::exists(path, unknown) && !unknown;
}

// "left" of the clip "duo_left" of the file "duo.pkl".
std::string part_of(const Clip& clip, const std::string& file) {
  const std::string begin = fs::path(file).stem().string() + "_";
  return clip.name.compare(0, begin.size(), begin) == 0 ? clip.name.substr(begin.size())
                                                        : clip.name;
}

// The parts of a file's motions, of many the first ones.
template <class Motions>
std::string parts_text(const Motions& motions, const std::string& file) {
  constexpr std::size_t kMost = 12;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < std::min(kMost, motions.size()); ++i)
    parts.push_back(part_of(motions[i].clip, file));
  return join(parts, ", ") + (motions.size() > kMost ? ", ..." : "");
}

std::vector<ReadMotion> read_file(const PartName& name, const MotionReading& reading) {
  ReadOptions options = reading;
  options.part = name.part;
  std::vector<ReadMotion> motions = read_clips(name.file, options);
  if (reading.remarks)
    for (const ReadMotion& motion : motions) reading.remarks->add(name.file, motion.report.remarks);
  if (name.part.empty()) return motions;
  const std::string whole = fs::path(name.file).stem().string() + "_" + name.part;
  const auto found = std::find_if(motions.begin(), motions.end(), [&](const ReadMotion& motion) {
    return motion.clip.name == whole;
  });
  if (found != motions.end()) return {std::move(*found)};
  if (motions.size() > 1)
    throw DataError(in_file(name.file),
                    "has no part \"" + name.part + "\", only " + parts_text(motions, name.file));
  // Either the part, named as the file because it is the only one asked for, or all that the file
  // holds, of a format that knows no parts.
  options.part.clear();
  if (read_clips(name.file, options).size() == 1)
    throw DataError(in_file(name.file), "holds one motion: name it without #" + name.part);
  motions.front().clip.name = whole;
  return motions;
}

// The entry that a text names, and in `range` which part of it; null for none.
const DatasetEntry* find_entry(const Dataset& dataset, const std::string& text, ClipRange& range) {
  range = {text};
  if (const DatasetEntry* whole = dataset.find(text)) return whole;
  range = parse_clip_range(text);
  return dataset.find(range.clip);
}

}  // namespace

ClipRange parse_clip_range(const std::string& text) {
  ClipRange range{text};
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return range;
  const std::string rest = text.substr(colon + 1);
  const std::size_t dash = rest.find('-');
  if (dash == std::string::npos || rest.find_first_not_of("0123456789.-") != std::string::npos)
    return range;
  range.clip = text.substr(0, colon);
  range.from = seconds_of(rest.substr(0, dash), text);
  if (dash + 1 < rest.size()) {
    range.to = seconds_of(rest.substr(dash + 1), text);
    if (range.to <= range.from)
      throw UsageError("\"" + text + "\": the range must end after it begins");
  }
  return range;
}

RangedClip cut(const Clip& whole, const ClipRange& range) {
  const auto first = static_cast<Eigen::Index>(std::llround(range.from * whole.fps));
  if (first >= whole.frames())
    throw UsageError("a part of " + range.clip + " begins at " + format_number(range.from) +
                     " s, but the clip has only " + format_fixed(whole.seconds(), 2) + " s");
  const auto last =
      range.to > 0 ? std::min(whole.frames(),
                              std::max<Eigen::Index>(first + 1, std::llround(range.to * whole.fps)))
                   : whole.frames();
  RangedClip out;
  out.from = static_cast<double>(first) / whole.fps;
  out.clip = slice(whole, first, last - first);
  return out;
}

PartName split_part(const std::string& text) {
  if (is_there(text)) return {text, ""};
  for (std::size_t at = text.rfind('#'); at != std::string::npos && at > 0;
       at = text.rfind('#', at - 1)) {
    const std::string file = text.substr(0, at);
    if (at + 1 < text.size() && is_there(file)) return {file, text.substr(at + 1)};
  }
  return {text, ""};
}

std::vector<RangedClip> read_clip_ranges(const std::string& text, const Dataset* dataset,
                                         const MotionReading& reading) {
  ClipRange range;
  if (dataset != nullptr)
    if (const DatasetEntry* entry = find_entry(*dataset, text, range)) {
      RangedClip one = cut(load_clip(*dataset, *entry), range);
      one.entry = entry;
      return {one};
    }
  range = parse_clip_range(text);
  const PartName name = split_part(range.clip);
  if (dataset != nullptr && !is_motion_file(name.file) && !is_there(name.file)) {
    std::vector<std::string> names;
    for (const DatasetEntry& entry : dataset->entries) names.push_back(entry.name);
    throw DataError(in_file(range.clip), "is neither a clip of " + dataset->directory.string() +
                                             " nor a motion file" +
                                             did_you_mean(range.clip, names));
  }
  std::vector<RangedClip> all;
  for (ReadMotion& motion : read_file(name, reading)) all.push_back(cut(motion.clip, range));
  return all;
}

RangedClip read_clip_range(const std::string& text, const Dataset* dataset,
                           const MotionReading& reading) {
  std::vector<RangedClip> all = read_clip_ranges(text, dataset, reading);
  if (all.size() == 1) return std::move(all.front());
  const std::string file = split_part(parse_clip_range(text).clip).file;
  throw DataError(in_file(file), "holds " + std::to_string(all.size()) +
                                     " motions, expected one: name it as " + file + "#" +
                                     part_of(all.front().clip, file) + "; the parts are " +
                                     parts_text(all, file));
}

}  // namespace mocaplm
