#include "motion/clip.h"

#include <cassert>
#include <cmath>
#include <cstdint>

#include "common/error.h"
#include "common/text.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr double kAbsurdClipValue = 1e6;
constexpr double kSlowest = 1e-6;  // frames per second; the times of slower ones overflow in files

bool sane(double value) {
  return std::isfinite(value) && std::abs(value) <= kAbsurdClipValue;
}

// Without a branch a value: nearly always all is well, and a look at all values is all it takes.
template <class Matrix>
bool all_sane(const Matrix& matrix) {
  const double* values = matrix.data();
  std::int64_t insane = 0;
  for (Eigen::Index i = 0; i < matrix.size(); ++i)
    insane += !(std::abs(values[i]) <= kAbsurdClipValue);
  return insane == 0;
}

}  // namespace

void check_clip(const Clip& clip, const std::string& file) {
  if (clip.frames() == 0) throw DataError(in_file(file), "has no frames");
  if (clip.trans.rows() != clip.frames())
    throw DataError(in_file(file), "has " + std::to_string(clip.frames()) +
                                       " frames of poses but " + std::to_string(clip.trans.rows()) +
                                       " of translation");
  if (!(clip.fps >= kSlowest && clip.fps <= 10000))  // nor NaN
    throw DataError(in_file(file), "frame rate " + format_number(clip.fps) +
                                       ", expected between 0.000001 and 10000 per second");
  if (all_sane(clip.poses) && all_sane(clip.trans)) return;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    for (Eigen::Index c = 0; c < 72; ++c)
      if (!sane(clip.poses(t, c)))
        throw DataError(at_joint(file, static_cast<std::size_t>(t),
                                 joint_names()[static_cast<std::size_t>(c / 3)]),
                        "rotation is " + format_number(clip.poses(t, c)) +
                            ", expected a finite angle in radians");
    for (Eigen::Index c = 0; c < 3; ++c)
      if (!sane(clip.trans(t, c)))
        throw DataError(
            at_frame(file, static_cast<std::size_t>(t)),
            "translation is " + format_number(clip.trans(t, c)) + ", expected finite metres");
  }
}

Clip slice(const Clip& clip, Eigen::Index first, Eigen::Index count) {
  assert(first >= 0 && count >= 0 && first + count <= clip.frames());
  Clip part;
  part.name = clip.name;
  part.fps = clip.fps;
  part.poses = clip.poses.middleRows(first, count);
  part.trans = clip.trans.middleRows(first, count);
  part.labels = clip.labels;
  part.body = clip.body;
  return part;
}

}  // namespace mocaplm
