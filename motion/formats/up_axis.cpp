#include "motion/formats/up_axis.h"

#include <algorithm>

#include "common/error.h"
#include "common/text.h"
#include "motion/rotation.h"

namespace mocaplm {

const std::vector<std::string>& up_axis_names() {
  static const std::vector<std::string> names = {"auto", "x", "y", "z", "-x", "-y", "-z"};
  return names;
}

UpAxis up_axis_of(const std::string& name) {
  const auto& names = up_axis_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw UsageError("up axis \"" + name + "\", expected one of " + join(names, ", "));
  return static_cast<UpAxis>(found - names.begin());
}

std::string to_string(UpAxis up) {
  return up_axis_names()[static_cast<std::size_t>(up)];
}

Eigen::Vector3d up_vector(UpAxis up) {
  const int index = static_cast<int>(up) - 1;
  return (index < 3 ? 1 : -1) * Eigen::Vector3d::Unit(index % 3);
}

Eigen::Matrix3d turn_to_y_up(UpAxis up) {
  // Named, since half a turn has no smallest axis.
  if (up == UpAxis::minus_y) return Eigen::Vector3d(1, -1, -1).asDiagonal();
  return shortest_rotation(up_vector(up), Eigen::Vector3d::UnitY()).toRotationMatrix();
}

}  // namespace mocaplm
