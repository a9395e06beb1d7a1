#include "motion/formats/world_turn.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "common/text.h"

namespace mocaplm {

namespace {

constexpr UpAxis kUpAxes[] = {UpAxis::y,       UpAxis::z,       UpAxis::x,
                              UpAxis::minus_y, UpAxis::minus_z, UpAxis::minus_x};

UpAxis axis_of(const Eigen::Vector3d& v) {
  for (const UpAxis axis : kUpAxes)
    if (up_vector(axis).dot(v) > 0.9) return axis;
  return UpAxis::y;
}

UpAxis named(const std::string& name) {
  return up_axis_of(name[0] == '+' ? name.substr(1) : name);
}

// In how many of some frames the figure stands along each axis, and of these in how many its feet
// are near to where that axis is 0.
class Upright {
 public:
  Upright(const std::vector<BvhPose>& poses, const SourceFigure& figure) {
    for (const BvhPose& pose : poses) {
      const Eigen::Vector3d hips = figure.middle(pose, 1, 2), ankles = figure.middle(pose, 7, 8);
      const Eigen::Vector3d trunk = (figure.middle(pose, 16, 17) - hips).normalized();
      const Eigen::Vector3d legs = (hips - ankles).normalized();
      const double leg = figure.leg(pose);
      for (const UpAxis axis : kUpAxes) {
        const Eigen::Vector3d up = up_vector(axis);
        if (trunk.dot(up) < 0.7 || legs.dot(up) < 0.6) continue;
        ++stands_[static_cast<std::size_t>(axis)];
        const double foot = std::min(figure.at(pose, 7).dot(up), figure.at(pose, 8).dot(up));
        grounded_[static_cast<std::size_t>(axis)] += foot > -0.2 * leg && foot < 0.4 * leg;
      }
      ++frames_;
    }
  }
  double stands(UpAxis axis) const { return stands_[static_cast<std::size_t>(axis)] / frames_; }
  double grounded(UpAxis axis) const { return grounded_[static_cast<std::size_t>(axis)] / frames_; }

 private:
  double frames_ = 0;
  double stands_[7] = {}, grounded_[7] = {};
};

}  // namespace

WorldTurn find_world_turn(const std::vector<BvhPose>& poses, const RetargetMap& map,
                          const SourceFigure& figure, const RestPose& rest, UpAxis option) {
  WorldTurn out;
  const UpAxis of_rest = rest.up ? axis_of(*rest.up) : UpAxis::y;
  UpAxis up = option;
  if (up == UpAxis::automatic && !map.up.empty()) up = named(map.up);
  if (up == UpAxis::automatic) {
    up = of_rest;
    const Upright upright(poses, figure);
    // One who lies on the floor lies along any axis; one who stands has the floor under the feet.
    if (upright.stands(of_rest) < 0.3)
      for (const UpAxis axis : kUpAxes)
        if (axis != of_rest && upright.stands(axis) > 0.7 && upright.grounded(axis) > 0.7) {
          up = axis;
          out.remark = "the rest pose has " + to_string(of_rest) +
                       " up, but in the motion the figure stands along " + to_string(axis) +
                       ", which is taken as up (--up " + to_string(of_rest) + " takes the other)";
          break;
        }
  }
  const bool alike = rest.up && up_vector(up) == *rest.up;
  if (!map.facing.empty()) {
    const Eigen::Vector3d facing = up_vector(named(map.facing));
    if (facing.dot(up_vector(up)) == 0) {  // else it is of the rest pose alone
      out.turn = to_front(up_vector(up), up_vector(up).cross(facing));
      return out;
    }
  }
  out.turn = alike && rest.zero ? rest.front : turn_to_y_up(up);
  return out;
}

Eigen::Vector3d root_offset_to_add(const Bvh& bvh, const std::vector<BvhPose>& poses,
                                   const SourceFigure& figure, const Eigen::Matrix3d& turn) {
  const double offset = (turn * bvh.joints.front().offset).y();
  std::vector<double> lowest;
  double leg = 0;
  for (const BvhPose& pose : poses) {
    leg = figure.leg(pose);
    lowest.push_back(std::min((turn * figure.at(pose, 7)).y(), (turn * figure.at(pose, 8)).y()));
  }
  if (!(offset > 0.7 * leg)) return Eigen::Vector3d::Zero();
  const auto lower_than = [&](std::size_t share) {
    const auto at = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / share);
    std::nth_element(lowest.begin(), at, lowest.end());
    return *at;
  };
  // Ankles are a tenth of a leg above the floor. A climber is on it for a while only: then the
  // lowest tenth must lie just there.
  const double usual = lower_than(2), low = lower_than(10);
  const bool walks = usual < -0.5 * leg && usual + offset > -0.15 * leg;
  const bool climbs = low < -0.5 * leg && std::abs(low + offset - 0.1 * leg) < 0.12 * leg;
  return walks || climbs ? Eigen::Vector3d(0, offset, 0) : Eigen::Vector3d::Zero();
}

}  // namespace mocaplm
