// What a user names as a piece of motion: CLIP or CLIP:from-to, a file or a dataset's clip,
// seconds.
#pragma once

#include <string>

#include "motion/clip.h"
#include "motion/dataset.h"
#include "motion/formats/formats.h"

namespace mocaplm {

struct ClipRange {
  std::string clip;
  double from = 0, to = 0;  // seconds; 0 for the clip's end
};

// "walk", "walk.npz:1.5-3.6", "walk:2-" (to the end). What follows the last colon is a range when
// it holds nothing but digits, points and a '-'. Throws UsageError for one that is empty or
// backwards.
ClipRange parse_clip_range(const std::string& text);

struct RangedClip {
  Clip clip;                            // the range alone
  double from = 0;                      // seconds of the whole clip where it begins
  const DatasetEntry* entry = nullptr;  // where it is a clip of the dataset
};

// A dataset's clip of this name if there is one (`dataset` may be null), else a motion file, read
// as `options` say. Throws UsageError when the range begins beyond the clip's end, DataError when
// there is neither clip nor file.
RangedClip read_clip_range(const std::string& text, const Dataset* dataset,
                           const ReadOptions& options = {});

}  // namespace mocaplm
