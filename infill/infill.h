// Missing joints, frames or both of a clip, filled by a masked model.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "infill/fill.h"
#include "motion/clip.h"

namespace mocaplm {

struct InfillOptions {
  std::filesystem::path model;
  Clip clip;
  std::vector<int> joints;  // missing ones; none: all, with the root's translation
  double from = 0, to = 0;  // seconds; to = 0: up to the clip's end
  Labels labels;            // conditions
  FillOptions fill;
  std::string device = "auto", precision = "auto";
  int threads = 0;
};

// Angles between rotations of the missing part and of the clip itself, degrees.
struct FillError {
  double mean = 0, most = 0;
};

struct InfillResult {
  Clip original, filled;             // at the model's rate
  std::vector<int> joints;           // filled ones that the model tells
  Eigen::Index first = 0, last = 0;  // frames [first, last) were missing
  std::int64_t tokens = 0;           // filled ones
  FillError error;
  FillError bins;                 // of the clip's own tokens: what the bins alone cost
  std::optional<FillError> line;  // of slerp between the frames around, where frames are known
  bool procedural = false;
};

// Joints that the model does not tell are interpolated where all joints are missing. The root's
// path through missing frames is bent so that it ends where the clip goes on. Throws UsageError
// when the model is not masked, lacks a joint, or nothing is known or missing; DataError for labels
// that it does not know.
InfillResult infill(const InfillOptions& options);

// The clip with the frames [first, last) of all joints and the root on the line (slerp) between the
// frames beside them; where one side is missing the other's frame stays. Not all frames may be.
Clip bridged(const Clip& clip, Eigen::Index first, Eigen::Index last);

// Between the rotations of some joints in the frames [first, last) of two clips.
FillError fill_error(const Clip& a, const Clip& b, const std::vector<int>& joints,
                     Eigen::Index first, Eigen::Index last);

}  // namespace mocaplm
