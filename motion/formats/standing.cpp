#include "motion/formats/standing.h"

#include <Eigen/Geometry>
#include <cmath>

#include "common/angles.h"
#include "common/text.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

double degrees_apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return angle_between(a, b) / kRadians;
}

// Degrees that a pose may be off.
struct Limits {
  double trunk, leg, knee, elbow, level, twist, raised, uneven;
};
constexpr Limits kLoose = {25, 32, 30, 40, 20, 35, 30, 25};
constexpr Limits kStrict = {12, 15, 15, 25, 10, 12, 20, 15};

class Check {
 public:
  Check(const SourceFigure& figure, const BvhPose& pose, const Limits& limits)
      : figure_(figure), pose_(pose), limits_(limits) {}

  Standing run() {
    const Eigen::Vector3d hips = figure_.middle(pose_, 1, 2);
    const Eigen::Vector3d trunk = figure_.middle(pose_, 16, 17) - hips;
    out_.up = nearest_axis(trunk);
    limit(degrees_apart(trunk, out_.up), limits_.trunk, "the trunk leans");
    const Eigen::Vector3d hip_line = at(1) - at(2), shoulder_line = at(16) - at(17);
    limit(std::abs(90 - degrees_apart(hip_line, out_.up)), limits_.level,
          "the hips are off the level");
    limit(std::abs(90 - degrees_apart(shoulder_line, out_.up)), limits_.level,
          "the shoulders are off the level");
    limit(degrees_apart(level(hip_line), level(shoulder_line)), limits_.twist,
          "the shoulders are turned against the hips");
    if (shoulder_line.norm() < 0.5 * hip_line.norm()) fail("the shoulders are folded in");
    out_.left = level(hip_line).normalized() + level(shoulder_line).normalized();
    out_.left = out_.left.norm() > 1e-9 ? out_.left.normalized() : Eigen::Vector3d::UnitX();
    for (const int side : {0, 1}) {
      const Eigen::Vector3d thigh = at(4 + side) - at(1 + side), shin = at(7 + side) - at(4 + side);
      const Eigen::Vector3d leg = at(7 + side) - at(1 + side);
      limit(degrees_apart(leg, -out_.up), limits_.leg, "a leg is off the vertical");
      limit(degrees_apart(thigh, shin), limits_.knee, "a knee is bent");
    }
    if (figure_.has(15) && (at(15) - figure_.middle(pose_, 16, 17)).dot(out_.up) < 0)
      fail("the head is not above the shoulders");
    arms();
    if (!out_.why_not.empty()) out_.stance = RestStance::none;
    return out_;
  }

 private:
  Eigen::Vector3d at(int smpl) const { return figure_.at(pose_, smpl); }
  Eigen::Vector3d level(const Eigen::Vector3d& v) const { return v - v.dot(out_.up) * out_.up; }
  void fail(const std::string& why) {
    if (out_.why_not.empty()) out_.why_not = why;
  }
  void limit(double degrees, double most, const std::string& what) {
    // Not "> most": a bone of no length has no angle.
    if (!(degrees <= most)) fail(what + " by " + format_fixed(degrees, 0) + " degrees");
  }

  void arms() {
    double raised[2];
    for (const int side : {0, 1}) {
      const Eigen::Vector3d upper = at(18 + side) - at(16 + side);
      const Eigen::Vector3d lower = at(20 + side) - at(18 + side);
      const Eigen::Vector3d outward = side == 0 ? out_.left : Eigen::Vector3d(-out_.left);
      limit(degrees_apart(upper, lower), limits_.elbow, "an elbow is bent");
      const Eigen::Vector3d arm = at(20 + side) - at(16 + side);
      raised[side] = 90 - degrees_apart(arm, out_.up);
      if (raised[side] > limits_.raised)
        fail("an arm is raised by " + format_fixed(raised[side], 0) + " degrees");
      if (raised[side] > -70 && arm.dot(outward) < 0.5 * level(arm).norm())
        fail("an arm does not point to its side");
    }
    limit(std::abs(raised[0] - raised[1]), limits_.uneven, "the arms hang unequally");
    const double lower = std::min(raised[0], raised[1]);
    out_.stance = lower > -25   ? RestStance::t_pose
                  : lower > -70 ? RestStance::a_pose
                                : RestStance::hanging;
  }

  const SourceFigure& figure_;
  const BvhPose& pose_;
  const Limits& limits_;
  Standing out_;
};

}  // namespace

Standing standing_in(const SourceFigure& figure, const BvhPose& pose, bool strict) {
  return Check(figure, pose, strict ? kStrict : kLoose).run();
}

Eigen::Matrix3d to_front(const Eigen::Vector3d& up, const Eigen::Vector3d& left) {
  Eigen::Matrix3d turn;
  turn << left.transpose(), up.transpose(), left.cross(up).transpose();
  return turn;
}

Eigen::Vector3d nearest_axis(const Eigen::Vector3d& v) {
  Eigen::Index axis;
  v.cwiseAbs().maxCoeff(&axis);
  return (v[axis] < 0 ? -1 : 1) * Eigen::Vector3d::Unit(axis);
}

}  // namespace mocaplm
