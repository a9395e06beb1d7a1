#include "motion/ik/points.h"

namespace mocaplm {

const std::string& point_name(int point) {
  static const std::array<std::string, kPoints - kJoints> extra = {
      "top of the head", "nose", "left_ear", "right_ear", "left_heel", "right_heel"};
  return point < kJoints ? joint_names()[static_cast<std::size_t>(point)]
                         : extra[static_cast<std::size_t>(point - kJoints)];
}

const std::array<int, 12>& needed_points() {
  static const std::array<int, 12> needed = {1, 2, 4, 5, 7, 8, 16, 17, 18, 19, 20, 21};
  return needed;
}

}  // namespace mocaplm
