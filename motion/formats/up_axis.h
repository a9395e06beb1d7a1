// Which axis of a file points up.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mocaplm {

// automatic: what the format, the skeleton or the motion itself says.
enum class UpAxis { automatic, x, y, z, minus_x, minus_y, minus_z };

// "auto", "x", "y", "z", "-x", "-y", "-z": what --up takes, in the enum's order.
const std::vector<std::string>& up_axis_names();
UpAxis up_axis_of(const std::string& name);  // throws UsageError for other names
std::string to_string(UpAxis up);

// The unit vector that points up in the file; not for `automatic`.
Eigen::Vector3d up_vector(UpAxis up);
// The rotation that brings the file's world into ours (Y up), the smallest one; for -y half a turn
// about x, which takes a camera's axes (x right, y down, z away from it) to x right, y up, z
// towards it. z up is turned by -90 degrees about x. Not for `automatic`.
Eigen::Matrix3d turn_to_y_up(UpAxis up);

}  // namespace mocaplm
