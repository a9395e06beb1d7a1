#include "emulator/landmarks.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

// The direction that the person faces on the ground, not of unit length: x and z.
Eigen::Vector2d facing(const JointPositions& joints) {
  static const int pairs[4] = {joint_index("left_hip"), joint_index("right_hip"),
                               joint_index("left_shoulder"), joint_index("right_shoulder")};
  const Eigen::Vector3d across =
      (joints.row(pairs[0]) - joints.row(pairs[1]) + joints.row(pairs[2]) - joints.row(pairs[3]))
          .transpose();
  // across x up
  return {-across.z(), across.x()};
}

// The angle about y of each frame's heading that is to be taken away.
std::vector<double> heading_angles(const std::vector<JointPositions>& frames,
                                   const std::string& heading) {
  std::vector<double> angles(frames.size(), 0.0);
  if (heading == "keep") return angles;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const Eigen::Vector2d forward = facing(frames[t]);
    // Who lies on the side faces nowhere: the direction before holds on.
    angles[t] = forward.norm() > 1e-6 ? std::atan2(forward.x(), forward.y())
                                      : (t > 0 ? angles[t - 1] : 0.0);
    if (forward.norm() > 1e-6) sum += forward.normalized();
  }
  const double one = heading == "mean" ? std::atan2(sum.x(), sum.y()) : angles[0];
  if (heading != "every") std::fill(angles.begin(), angles.end(), one);
  return angles;
}

}  // namespace

void check_tree(const LandmarkTree& tree) {
  if (tree.names.size() < 2 || tree.names.size() != tree.parents.size())
    throw UsageError("a landmark tree needs 2 landmarks or more, each with its parent");
  if (tree.parents[0] != -1) throw UsageError("landmark 0 must be the root, with parent -1");
  for (std::size_t i = 1; i < tree.parents.size(); ++i)
    if (tree.parents[i] < 0 || tree.parents[i] >= static_cast<int>(i))
      throw UsageError("landmark " + tree.names[i] + ": its parent must come before it");
}

LandmarkTree smpl_landmarks(const std::vector<int>& joints) {
  std::vector<int> chosen = joints;
  for (int j = 0; joints.empty() && j < kJoints; ++j) chosen.push_back(j);
  chosen.push_back(0);
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  LandmarkTree tree;
  for (const int joint : chosen) {
    tree.names.push_back(joint_names()[static_cast<std::size_t>(joint)]);
    int parent = joint_parents()[static_cast<std::size_t>(joint)];
    auto at = std::find(chosen.begin(), chosen.end(), parent);
    while (parent >= 0 && at == chosen.end()) {
      parent = joint_parents()[static_cast<std::size_t>(parent)];
      at = std::find(chosen.begin(), chosen.end(), parent);
    }
    tree.parents.push_back(parent < 0 ? -1 : static_cast<int>(at - chosen.begin()));
  }
  check_tree(tree);
  return tree;
}

PostureSequence posture_sequence(
    const LandmarkTree& tree,
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& positions,
    const Place& place) {
  check_tree(tree);
  const auto n = static_cast<Eigen::Index>(tree.names.size());
  if (positions.rows() == 0 || positions.rows() % n != 0)
    throw DataError(place, std::to_string(positions.rows()) + " landmark positions, expected " +
                               std::to_string(n) + " for each frame");
  PostureSequence sequence;
  sequence.values.resize(3 * (n - 1), positions.rows() / n);
  for (Eigen::Index t = 0; t < sequence.frames(); ++t)
    for (Eigen::Index i = 1; i < n; ++i) {
      const auto parent = tree.parents[static_cast<std::size_t>(i)];
      const Eigen::Vector3d limb =
          (positions.row(t * n + i) - positions.row(t * n + parent)).transpose();
      const double length = limb.norm();
      if (!std::isfinite(length) || length < 1e-9)
        throw DataError(place, "frame " + std::to_string(t) + ": " +
                                   tree.names[static_cast<std::size_t>(i)] + " and " +
                                   tree.names[static_cast<std::size_t>(parent)] +
                                   (std::isfinite(length) ? " lie at one point: no direction"
                                                          : " have positions that are not finite"));
      sequence.at(t).col(i - 1) = limb / length;
    }
  return sequence;
}

const std::vector<std::string>& heading_names() {
  static const std::vector<std::string> names = {"keep", "start", "mean", "every"};
  return names;
}

PostureSequence clip_postures(const Clip& clip, const LandmarkTree& tree,
                              const std::string& heading) {
  if (std::find(heading_names().begin(), heading_names().end(), heading) == heading_names().end())
    throw UsageError("unknown heading \"" + heading + "\"" + known_names(heading, heading_names()));
  check_clip(clip, clip.name);
  std::vector<JointPositions> frames;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) frames.push_back(joint_positions(clip, t));
  const std::vector<double> angles = heading_angles(frames, heading);
  std::vector<int> joints;
  for (const std::string& name : tree.names) joints.push_back(joint_index(name));
  const auto n = static_cast<Eigen::Index>(joints.size());
  JointPositions positions(n * clip.frames(), 3);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const auto frame = static_cast<std::size_t>(t);
    const double c = std::cos(angles[frame]), s = std::sin(angles[frame]);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::RowVector3d p =
          frames[frame].row(joints[static_cast<std::size_t>(i)]) - frames[frame].row(0);
      positions.row(t * n + i) << c * p.x() - s * p.z(), p.y(), s * p.x() + c * p.z();
    }
  }
  return posture_sequence(tree, positions, in_file(clip.name));
}

}  // namespace mocaplm
