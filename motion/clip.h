// One piece of motion: the currency that every part of the program speaks.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

namespace mocaplm {

// (frames, 72): SMPL's 24 joints, axis-angle in radians, column 3 * joint + axis.
using Poses = Eigen::Matrix<double, Eigen::Dynamic, 72, Eigen::RowMajor>;
// (frames, 3): metres.
using Translations = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
// Label name to value: "genre" -> "waack", "dancer" -> "d26", "content" -> "walk".
using Labels = std::map<std::string, std::string>;

struct Clip {
  std::string name;
  double fps = 0;      // frames per second of the source
  Poses poses;         // Y up, the character faces +Z at zero rotation, its left is +X
  Translations trans;  // SMPL's `trans`: the pelvis joint lies at trans + rest_joints().row(0)
  Labels labels;

  Eigen::Index frames() const { return poses.rows(); }
  double seconds() const { return fps > 0 ? static_cast<double>(frames()) / fps : 0; }
};

// Throws DataError naming the frame and joint of the first non-finite value, or when the clip is
// empty, the row counts differ, the rate is not in [1e-6, 10000] or a value is absurdly large
// (1e6).
void check_clip(const Clip& clip, const std::string& file);

// Frames [first, first + count); the range must lie inside the clip.
Clip slice(const Clip& clip, Eigen::Index first, Eigen::Index count);

}  // namespace mocaplm
