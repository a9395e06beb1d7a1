// One piece of motion: the currency that every part of the program speaks.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mocaplm {

// (frames, 72): SMPL's 24 joints, axis-angle in radians, column 3 * joint + axis.
using Poses = Eigen::Matrix<double, Eigen::Dynamic, 72, Eigen::RowMajor>;
// (frames, 3): metres.
using Translations = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
// Label name to value: "genre" -> "waack", "dancer" -> "d26", "content" -> "walk".
using Labels = std::map<std::string, std::string>;

// (24, 3): where SMPL's joints lie in the rest pose, metres.
using RestJoints = Eigen::Matrix<double, 24, 3, Eigen::RowMajor>;

// Whose body moves, as far as a file says it.
struct BodyShape {
  std::vector<double> betas;       // SMPL's shape coefficients, as in the file; empty: not said
  std::string gender;              // "neutral", "female", "male"; "": not said
  std::optional<RestJoints> rest;  // of this shape, from a model file; none: the mean body's
};

struct Clip {
  std::string name;
  double fps = 0;      // frames per second of the source
  Poses poses;         // Y up, the character faces +Z at zero rotation, its left is +X
  Translations trans;  // SMPL's `trans`: the pelvis joint lies at trans + rest_joints(*this).row(0)
  Labels labels;
  std::shared_ptr<const BodyShape> body;  // shared by all parts of a clip; null: nothing is known

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
