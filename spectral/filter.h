// A motion rebuilt from some of its frequencies (thesis 3.6, Figure 3.5).
#pragma once

#include <string>

#include "common/settings.h"
#include "common/table.h"
#include "motion/clip.h"

namespace mocaplm {

struct FilterConfig {
  std::string keep = "low";
  double from_hz = 1;
  double to_hz = 3;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("keep", keep, {"low", "band"},
             "the movement up to to_hz, or only that from from_hz to to_hz");
    v.number("from_hz", from_hz, 0, 5000, "band: lowest frequency kept");
    v.number("to_hz", to_hz, 0, 5000, "highest frequency kept");
  }
};

struct FilterResult {
  Clip filtered;
  Eigen::Index first = 0, last = 0;  // DCT coefficients kept beside the mean: [first, last)
  double kept_share = 0;             // of the rotations' movement (squares, without the mean)
};

// Each rotation component's and the root's course over the whole clip becomes its DCT; coefficients
// outside the range are dropped, the mean (coefficient 0) stays, so that the dancer keeps posture
// and place. Coefficient k of n frames has k * fps / (2 n) Hz. Rotation vectors run on without
// jumps while they are transformed; whatever comes out is a rotation. Throws UsageError for an
// empty range or one that holds no coefficient, DataError for a clip of one frame.
FilterResult filter_clip(const Clip& clip, const FilterConfig& config);

// Roughness, fast share, and angle between both.
Table filter_table(const Clip& clip, const FilterResult& result, const FilterConfig& config);

}  // namespace mocaplm
