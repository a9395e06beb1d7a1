// A standing, walking motion and the files that other programs would write of it, for the tests.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/random.h"
#include "motion/formats/npy.h"
#include "motion/formats/pickle_writer.h"
#include "motion/formats/up_axis.h"
#include "motion/helpers.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/turn.h"

namespace mocaplm {

using Entries = std::vector<std::pair<std::string, std::string>>;

// Upright, arms down and swinging, turning on the spot, one metre forward; hands are zero.
inline Clip walker(Eigen::Index frames = 12, double fps = 30) {
  Random random(77);
  Clip clip;
  clip.name = "walker";
  clip.fps = fps;
  clip.poses = Poses::Zero(frames, 72);
  clip.trans.resize(frames, 3);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const double phase = static_cast<double>(t) / static_cast<double>(frames);
    for (Eigen::Index c = 3; c < 66; ++c) clip.poses(t, c) = random.uniform(-0.15, 0.15);
    clip.poses(t, 1) = 2 * phase;
    clip.poses(t, 3) = 0.4 * std::sin(6 * phase);
    clip.poses(t, 6) = -clip.poses(t, 3);
    clip.poses(t, 3 * 16 + 2) -= 1.2;
    clip.poses(t, 3 * 17 + 2) += 1.2;
    clip.trans.row(t) = Eigen::RowVector3d(0.1, 0.95, phase) - rest_joints().row(0);
  }
  return clip;
}

// The same motion in a file's world with `up` up.
inline Clip in_world(Clip clip, UpAxis up) {
  turn_world(clip, turn_to_y_up(up).transpose());
  return clip;
}

inline std::vector<double> values(const Clip& clip, Eigen::Index first, Eigen::Index count) {
  std::vector<double> out;
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    for (Eigen::Index c = 0; c < count; ++c)
      out.push_back(c + first < 72 ? clip.poses(t, first + c) : 0);
  return out;
}

inline std::vector<double> translations(const Clip& clip) {
  return {clip.trans.data(), clip.trans.data() + clip.trans.size()};
}

// Row-major matrices of the same rotations.
inline std::vector<double> matrices(const Clip& clip, int first, int count) {
  std::vector<double> out;
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    for (int j = first; j < first + count; ++j) {
      const Eigen::Matrix3d m =
          matrix_from_axis_angle(clip.poses.row(t).segment<3>(3 * j).transpose());
      for (int k = 0; k < 9; ++k) out.push_back(m(k / 3, k % 3));
    }
  return out;
}

inline std::pair<std::string, std::string> entry(const std::string& key,
                                                 const std::vector<double>& data,
                                                 const std::vector<std::size_t>& shape) {
  return {key + ".npy", npy_bytes(data.data(), shape)};
}

// AMASS's keys with this many columns.
inline Entries amass_entries(const Clip& clip, std::size_t columns,
                             const std::string& rate = "mocap_frame_rate") {
  const auto n = static_cast<std::size_t>(clip.frames());
  return {entry("poses", values(clip, 0, static_cast<Eigen::Index>(columns)), {n, columns}),
          entry("trans", translations(clip), {n, 3}), entry(rate, {clip.fps}, {})};
}

// The largest distance of a joint of two clips.
inline double apart(const Clip& a, const Clip& b) {
  if (a.frames() != b.frames()) return 1e9;
  double most = 0;
  for (Eigen::Index t = 0; t < a.frames(); ++t)
    most =
        std::max(most, (joint_positions(a, t) - joint_positions(b, t)).rowwise().norm().maxCoeff());
  return most;
}

}  // namespace mocaplm
