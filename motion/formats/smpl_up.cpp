#include "motion/formats/smpl_up.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/error.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr Eigen::Index kLooks = 100;  // frames
constexpr double kUpright = 0.71;     // cosine: trunk and legs within 45 degrees of the axis
constexpr double kShareFor = 0.6,
                 kShareElse = 0.1;  // shares of the frames: for one axis, for all others
// Against what the layout says.
constexpr double kNearlyAll = 0.8;

// How one frame stands along each signed axis, in UpAxis's order.
struct Stand {
  std::array<bool, 6> upright{};
  std::array<bool, 6> hands_down{};  // the hands are not over the head
};

Stand stand_of(const JointPositions& joints) {
  const Eigen::RowVector3d pelvis = joints.row(0), head = joints.row(15);
  const Eigen::RowVector3d ankles = (joints.row(7) + joints.row(8)) / 2;
  const Eigen::RowVector3d trunk = (head - pelvis).normalized();
  const Eigen::RowVector3d legs = (pelvis - ankles).normalized();
  Stand stand;
  for (std::size_t a = 0; a < 6; ++a) {
    const Eigen::RowVector3d axis = up_vector(static_cast<UpAxis>(a + 1)).transpose();
    stand.upright[a] = trunk.dot(axis) > kUpright && legs.dot(axis) > kUpright;
    const double hands = std::max(joints.row(20).dot(axis), joints.row(21).dot(axis));
    stand.hands_down[a] = hands < head.dot(axis);
  }
  return stand;
}

// The range of a joint's height along an axis.
struct Heights {
  double lowest = 1e9, highest = -1e9;
  void add(double height) {
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
};

}  // namespace

std::optional<UpAxis> find_up(const Clip& clip, UpAxis expected) {
  const Eigen::Index looks = std::min(clip.frames(), kLooks);
  if (looks == 0) return std::nullopt;
  std::array<double, 6> upright{}, hands_down{};
  Heights pelvis;
  std::array<double, 6> feet;
  feet.fill(1e9);
  Eigen::RowVector3d layout_up = Eigen::RowVector3d::Zero();
  if (expected != UpAxis::automatic) layout_up = up_vector(expected).transpose();
  for (Eigen::Index i = 0; i < looks; ++i) {
    const JointPositions joints = joint_positions(clip, i * clip.frames() / looks);
    const Stand stand = stand_of(joints);
    pelvis.add(joints.row(0).dot(layout_up));
    for (std::size_t a = 0; a < 6; ++a) {
      upright[a] += stand.upright[a];
      hands_down[a] += stand.upright[a] && stand.hands_down[a];
      const Eigen::RowVector3d axis = up_vector(static_cast<UpAxis>(a + 1)).transpose();
      for (const int foot : {10, 11}) feet[a] = std::min(feet[a], joints.row(foot).dot(axis));
    }
  }
  const auto best =
      static_cast<std::size_t>(std::max_element(upright.begin(), upright.end()) - upright.begin());
  const auto share = [&](double frames) { return frames / static_cast<double>(looks); };
  double others = 0;
  for (std::size_t a = 0; a < 6; ++a) others += a == best ? 0 : upright[a];
  if (share(upright[best]) < kShareFor || share(others) > kShareElse) return std::nullopt;
  const auto found = static_cast<UpAxis>(best + 1);
  if (found == expected || expected == UpAxis::automatic) return found;
  if (share(upright[best]) < kNearlyAll) return std::nullopt;
  // Upside down by the layout: a handstand, unless the hands hang down too.
  if (hands_down[best] < 0.5 * upright[best]) return std::nullopt;
  // Lying by the layout: likely where the pelvis is always just above its floor, and feet that
  // stand along the found axis do not stand on a floor at 0.
  const bool may_lie = pelvis.lowest > 0.03 && pelvis.highest < 0.4;
  if (may_lie && std::abs(feet[best]) > 0.25) return std::nullopt;
  return found;
}

UpAxis decide_up(const Clip& clip, UpAxis asked, UpAxis expected, UpLayout layout,
                 const std::string& file, std::vector<Remark>& remarks) {
  if (asked != UpAxis::automatic) return asked;
  if (layout == UpLayout::fixed) return expected;
  if (const std::optional<UpAxis> found = find_up(clip, expected)) {
    if (expected == UpAxis::automatic || found == expected) return *found;
    remarks.push_back({"up axis by the motion",
                       "its people stand along " + to_string(*found) +
                           ", while files of this layout usually have " + to_string(expected) +
                           " up: " + to_string(*found) + " is taken (--up says otherwise)"});
    return *found;
  }
  if (layout == UpLayout::usual) {
    remarks.push_back({"up axis by the layout",
                       "nobody stands upright for most of it; " + to_string(expected) +
                           " up is taken, as files of this layout usually have it (--up says "
                           "otherwise)"});
    return expected;
  }
  throw DataError(
      in_file(file),
      "does not say which axis is up, nor does its motion, in which nobody stands upright "
      "for most of the time: say --up y, --up z or another axis");
}

}  // namespace mocaplm
