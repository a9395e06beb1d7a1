// The trunk of a retargeted figure: pelvis, spine and chest. Rigs turn it by one to six joints at
// other heights than SMPL's three, hang arms from necks and undo a pelvis's turn in the hips; what
// is seen of a trunk is where the hips, the shoulders and the line between them point.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "motion/formats/rest_pose.h"
#include "motion/formats/source_figure.h"

namespace mocaplm {

// World rotations of SMPL's joints.
using Rotations = std::array<Eigen::Quaterniond, kJoints>;

class Trunk {
 public:
  // Looks at `poses`, some of the file's (some_poses), to see what the joints' own rotations leave
  // wrong. `turn` brings the file's world into ours. `keep_direction`: also the line from the hips
  // to the shoulders is kept.
  Trunk(const Bvh& bvh, const std::vector<BvhPose>& poses, const SourceFigure& figure,
        const RestPose& rest, const Eigen::Matrix3d& turn, bool keep_direction);

  // Pelvis: turned so that hips and the lower trunk lie as in the source, where the hips do not
  // turn with it. Chest: the same with the shoulders.
  void correct_ends(const BvhPose& pose, Rotations& world) const;
  // Fills the spine's joints that have no source: those above the chest's joint turn with it, the
  // others share the turn. Needs pelvis and chest.
  void fill_spine(Rotations& world) const;
  // Bends spine and (where its only joint is low) pelvis until the middle of SMPL's shoulders lies,
  // seen from its hips, where the source's lies seen from its pelvis.
  void keep_direction(const BvhPose& pose, Rotations& world) const;

 private:
  Eigen::Vector3d source_bone(const BvhPose& pose, int from, int to) const {
    return turn_ * (figure_.at(pose, to) - figure_.at(pose, from));
  }
  Eigen::Vector3d source_trunk(const BvhPose& pose) const;
  Eigen::Vector3d wanted(const BvhPose& pose, const Rotations& world) const;
  bool hips_turn_apart(const std::vector<BvhPose>& poses) const;
  bool shoulders_turn_apart(const Bvh& bvh, const std::vector<BvhPose>& poses) const;
  Eigen::Quaterniond own_rotation(const BvhPose& pose, int smpl) const;

  const SourceFigure& figure_;
  Eigen::Matrix3d turn_;
  bool keep_ = false, pelvis_off_ = false, chest_off_ = false;
  int base_ = -1;                             // the spine's lowest joint off the line of the hips
  int left_ = 16;                             // what the line of the chest is taken from: 13 or 16
  Eigen::Matrix3d pelvis_rest_, chest_rest_;  // joint's world rotation in the rest pose, inverse
  Eigen::Vector3d hips_, lower_, shoulders_, trunk_;  // in the rest pose, facing +Z
  std::array<double, 2> share_;  // of the turn from pelvis to chest: spine1, spine2
  std::array<double, 3> bend_;   // how pelvis, spine1, spine2 share the bending of keep_direction
};

}  // namespace mocaplm
