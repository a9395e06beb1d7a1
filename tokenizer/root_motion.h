// The root's way over the floor, seen by the dancer: steps to the left and forward in the heading
// of the pelvis. A step and a position (x, z) are metres; a heading is radians about +Y, 0 towards
// +Z.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mocaplm {

// Direction of the pelvis's +Z axis on the floor. Where that axis points straight up or down
// (within 3 degrees) the direction comes from the pelvis's +Y axis instead, so that it never
// divides by zero.
double heading(const Eigen::Vector3d& pelvis_axis_angle);
// The same as a vector (x, z) of unit length: (sin, cos) of the heading.
Eigen::Vector2d heading_direction(const Eigen::Vector3d& pelvis_axis_angle);

// (left, forward) of a floor vector (x, z) in a heading's direction, and back.
Eigen::Vector2d to_dancer(const Eigen::Vector2d& floor, const Eigen::Vector2d& direction);
Eigen::Vector2d to_floor(const Eigen::Vector2d& dancer, const Eigen::Vector2d& direction);

struct ValueRange {
  double low = 0, high = 0;
};

// The range of one absolute channel: all values, and a margin of a tenth of their spread at both
// ends (5 cm at least).
ValueRange absolute_range(const std::vector<double>& values);

// The range of a step channel: from the 0.1st to the 99.9th percentile with a margin of a quarter,
// so that one bad jump does not take the bins from all steps. Zero is the centre of a bin: who
// stands still stays. `symmetric` for a channel whose sign is a matter of mirroring.
ValueRange step_range(std::vector<double> values, int bins, bool symmetric);

}  // namespace mocaplm
