#include "tokenizer/root_motion.h"

#include <algorithm>
#include <cmath>

#include "motion/rotation.h"

namespace mocaplm {

Eigen::Vector2d heading_direction(const Eigen::Vector3d& pelvis_axis_angle) {
  const Eigen::Quaterniond world = quaternion_from_axis_angle(pelvis_axis_angle);
  const Eigen::Vector3d front = world * Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d floor(front.x(), front.z());
  const double length = floor.norm();
  if (length > 0.05) return floor / length;
  // On the back (front up) the crown points backwards, on the belly (front down) forwards.
  const Eigen::Vector3d crown = world * Eigen::Vector3d::UnitY() * (front.y() > 0 ? -1.0 : 1.0);
  return Eigen::Vector2d(crown.x(), crown.z()).normalized();
}

double heading(const Eigen::Vector3d& pelvis_axis_angle) {
  const Eigen::Vector2d direction = heading_direction(pelvis_axis_angle);
  return std::atan2(direction.x(), direction.y());
}

Eigen::Vector2d to_dancer(const Eigen::Vector2d& floor, const Eigen::Vector2d& direction) {
  const double s = direction.x(), c = direction.y();
  return {c * floor.x() - s * floor.y(), s * floor.x() + c * floor.y()};
}

Eigen::Vector2d to_floor(const Eigen::Vector2d& dancer, const Eigen::Vector2d& direction) {
  const double s = direction.x(), c = direction.y();
  return {c * dancer.x() + s * dancer.y(), -s * dancer.x() + c * dancer.y()};
}

ValueRange absolute_range(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double margin = std::max(0.05, 0.1 * (*high - *low));
  return {*low - margin, *high + margin};
}

namespace {

double percentile(std::vector<double>& values, double share) {
  const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

ValueRange step_range(std::vector<double> values, int bins, bool symmetric) {
  constexpr double kLeast = 0.01;  // metres: a corpus that stands still still gets sane bins
  double back = std::max(kLeast, -1.25 * percentile(values, 0.001));
  double ahead = std::max(kLeast, 1.25 * percentile(values, 0.999));
  if (symmetric) back = ahead = std::max(back, ahead);
  // `before` whole bins, then the one around zero, then `after`; their width covers both ends.
  const int before =
      std::clamp(static_cast<int>(std::lround((bins - 1) * back / (back + ahead))), 0, bins - 1);
  const int after = bins - 1 - before;
  const double width = std::max(back / (before + 0.5), ahead / (after + 0.5));
  return {-(before + 0.5) * width, (after + 0.5) * width};
}

}  // namespace mocaplm
