// What a user names as a piece of motion: CLIP or CLIP:from-to, a file or a dataset's clip,
// seconds; of a file with several people or takes FILE#PART or FILE#PART:from-to.
#pragma once

#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/dataset.h"
#include "motion/reading.h"

namespace mocaplm {

struct ClipRange {
  std::string clip;
  double from = 0, to = 0;  // seconds; 0 for the clip's end
};

// "walk", "walk.npz:1.5-3.6", "walk:2-" (to the end). What follows the last colon is a range when
// it holds nothing but digits, points and a '-'. Throws UsageError for one that is empty or
// backwards.
ClipRange parse_clip_range(const std::string& text);

struct PartName {
  std::string file;  // or a dataset's folder
  std::string part;  // "": the whole
};

// "duo.pkl#left", without a range. A file that is really called so wins; else what lies before the
// last '#' where that is there; else the text is a file that is not.
PartName split_part(const std::string& text);

struct RangedClip {
  Clip clip;                            // the range alone
  double from = 0;                      // seconds of the whole clip where it begins
  const DatasetEntry* entry = nullptr;  // where it is a clip of the dataset
};

// The frames of `whole` in the range, at least one. Throws UsageError when it begins beyond the
// end.
RangedClip cut(const Clip& whole, const ClipRange& range);

// A dataset's clip of this name if there is one (`dataset` may be null), else a motion file, read
// as `reading` says; all motions of the file, named "STEM_PART" where there are several. Seconds
// count from the first frame that --drop-first leaves, at the rate that --source-fps gives.
// Throws UsageError when the range begins beyond the clip's end, DataError when there is neither
// clip nor file, or no such part.
std::vector<RangedClip> read_clip_ranges(const std::string& text, const Dataset* dataset,
                                         const MotionReading& reading = {});

// The only one. Throws DataError naming the parts of a file with several.
RangedClip read_clip_range(const std::string& text, const Dataset* dataset,
                           const MotionReading& reading = {});

}  // namespace mocaplm
