#include "motion/clip_range.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "common/error.h"
#include "common/text.h"

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

RangedClip read_clip_range(const std::string& text, const Dataset* dataset,
                           const ReadOptions& options) {
  RangedClip out;
  ClipRange range{text};
  if (dataset != nullptr) out.entry = dataset->find(text);
  if (out.entry == nullptr) {
    range = parse_clip_range(text);
    if (dataset != nullptr) out.entry = dataset->find(range.clip);
  }
  if (out.entry != nullptr) {
    out.clip = load_clip(*dataset, *out.entry);
  } else if (dataset != nullptr && !is_motion_file(range.clip) &&
             !std::filesystem::exists(range.clip)) {
    std::vector<std::string> names;
    for (const DatasetEntry& entry : dataset->entries) names.push_back(entry.name);
    throw DataError(in_file(range.clip), "is neither a clip of " + dataset->directory.string() +
                                             " nor a motion file" +
                                             did_you_mean(range.clip, names));
  } else {
    out.clip = read_clip(range.clip, options);
  }
  const Clip& whole = out.clip;
  const auto first = static_cast<Eigen::Index>(std::llround(range.from * whole.fps));
  if (first >= whole.frames())
    throw UsageError("\"" + text + "\" begins at " + format_number(range.from) +
                     " s, but the clip has only " + format_fixed(whole.seconds(), 2) + " s");
  const auto last =
      range.to > 0 ? std::min(whole.frames(),
                              std::max<Eigen::Index>(first + 1, std::llround(range.to * whole.fps)))
                   : whole.frames();
  out.from = static_cast<double>(first) / whole.fps;
  out.clip = slice(whole, first, last - first);
  return out;
}

}  // namespace mocaplm
