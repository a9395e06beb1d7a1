#include "motion/formats/source_figure.h"

#include <Eigen/Geometry>
#include <vector>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

SourceFigure::SourceFigure(const Bvh& bvh, const RetargetMap& map, const std::string& file)
    : bvh_(bvh) {
  joints_.fill(-1);
  ends_.fill(Eigen::Vector3d::Zero());
  std::vector<std::string> absent, unnamed;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (map.joints[j].empty()) continue;
    joints_[j] = bvh.joint(map.joints[j]);
    if (joints_[j] < 0) absent.push_back(map.joints[j]);
  }
  for (const int j : required_joints())
    if (map.joints[joint_index(j)].empty()) unnamed.push_back(joint_names()[joint_index(j)]);
  if (!absent.empty())
    throw DataError(in_file(file), "has no joint " + join(absent, ", ") + ", which its map " +
                                       map.scheme + " names");
  if (!unnamed.empty())
    throw DataError(in_file(map.scheme),
                    "the map names no source joint for " + join(unnamed, ", "));
  find_limb_ends(rest_bvh(bvh));
}

Eigen::Vector3d SourceFigure::at(const BvhPose& pose, int smpl) const {
  if (has(smpl)) return pose.positions[joint_index(source(smpl))];
  const int before = joint_parents()[joint_index(smpl)];
  return pose.positions[joint_index(source(before))] +
         pose.rotations[joint_index(source(before))] * ends_[joint_index(smpl)];
}

void SourceFigure::find_limb_ends(const BvhPose& rest) {
  for (const int end : {7, 8, 20, 21}) {
    if (has(end)) continue;
    const int middle = joint_parents()[joint_index(end)],
              root = joint_parents()[joint_index(middle)];
    const Eigen::Vector3d bone = at(rest, middle) - at(rest, root);
    const Eigen::Matrix3d& turned = rest.rotations[joint_index(source(middle))];
    ends_[joint_index(end)] = turned.transpose() * bone;
    for (const Eigen::Vector3d& site : bvh_.joints[joint_index(source(middle))].end_sites)
      if (site.norm() > 0.5 * bone.norm() && site.norm() < 1.5 * bone.norm())
        ends_[joint_index(end)] = site;
  }
}

double SourceFigure::leg(const BvhPose& pose) const {
  const auto bone = [&](int a, int b) { return (at(pose, a) - at(pose, b)).norm(); };
  return 0.5 * (bone(1, 4) + bone(4, 7) + bone(2, 5) + bone(5, 8));
}

double SourceFigure::trunk(const BvhPose& pose) const {
  return (middle(pose, 1, 2) - middle(pose, 16, 17)).norm();
}

double SourceFigure::height(const BvhPose& pose) const {
  return 1.29 *
         (leg(pose) + trunk(pose));  // SMPL's mean body: 1.70 m from 1.32 m of legs and trunk
}

}  // namespace mocaplm
