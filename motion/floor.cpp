#include "motion/floor.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr double kFault = 0.03;  // metres

double lowest_sole(const Clip& clip, Eigen::Index frame) {
  const JointPositions joints = joint_positions(clip, frame);
  const auto rotations = joint_world_rotations(clip, frame);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Sole& sole : figure_soles()) {
    const Eigen::Matrix3d& rotation = rotations[static_cast<std::size_t>(sole.joint)];
    const double middle = joints(sole.joint, 1) + rotation.row(1).dot(sole.middle);
    lowest = std::min(lowest, middle - sole.radius);
  }
  return lowest;
}

}  // namespace

const std::array<Sole, 6>& figure_soles() {
  static const std::array<Sole, 6> soles = {{
      {7, {-0.008, -0.058, -0.04}, 0.032},
      {8, {0.008, -0.050, -0.04}, 0.032},
      {10, {0.0, 0.0, 0.0}, kSoleBelowFoot},
      {11, {0.0, 0.0, 0.0}, kSoleBelowFoot},
      {10, {0.015, -0.010, 0.07}, 0.024},
      {11, {-0.015, -0.010, 0.07}, 0.024},
  }};
  return soles;
}

double ground_below(std::vector<double> soles) {
  std::sort(soles.begin(), soles.end());
  const double usual = soles[soles.size() / 20];
  return usual - soles.front() > kFault ? usual : soles.front();
}

double ground_height(const Clip& clip) {
  std::vector<double> soles;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) soles.push_back(lowest_sole(clip, t));
  return ground_below(std::move(soles));
}

void stand_on_ground(Clip& clip) {
  clip.trans.col(1).array() -= ground_height(clip);
}

double floor_height(const Clip& clip) {
  std::vector<double> lowest;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions joints = joint_positions(clip, t);
    lowest.push_back(std::min({joints(7, 1), joints(8, 1), joints(10, 1), joints(11, 1)}));
  }
  const auto at = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 50);
  std::nth_element(lowest.begin(), at, lowest.end());
  return *at;
}

void align_floor(Clip& clip) {
  clip.trans.col(1).array() -= floor_height(clip);
}

}  // namespace mocaplm
