// The figure of a file in SMPL's terms: which of its joints is which, and where they lie.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "motion/formats/bvh.h"
#include "motion/formats/retarget_map.h"
#include "motion/skeleton.h"

namespace mocaplm {

// A joint that is there: not -1.
inline std::size_t joint_index(int joint) {
  return static_cast<std::size_t>(joint);
}

// Index of the source joint of every SMPL joint, -1 for none.
using SourceJoints = std::array<int, kJoints>;

class SourceFigure {
 public:
  // Throws DataError naming the joints that the file lacks and those that the map must name.
  SourceFigure(const Bvh& bvh, const RetargetMap& map, const std::string& file);

  const SourceJoints& joints() const { return joints_; }
  bool has(int smpl) const { return joints_[static_cast<std::size_t>(smpl)] >= 0; }
  int source(int smpl) const { return joints_[static_cast<std::size_t>(smpl)]; }

  // Where SMPL's joint lies in the file's world. A wrist or ankle without a joint lies where its
  // forearm or shin ends (find_limb_ends). Others must have a source.
  Eigen::Vector3d at(const BvhPose& pose, int smpl) const;
  Eigen::Vector3d middle(const BvhPose& pose, int left, int right) const {
    return 0.5 * (at(pose, left) + at(pose, right));
  }

  // Settles where forearms and shins end that have no joint at their end: at their End Site, where
  // it is half to one and a half times as far as the bone before is long, else straight on as far
  // again, in the pose `rest`.
  void find_limb_ends(const BvhPose& rest);

  // Hip to knee to ankle, mean of both sides; middle of the hips to middle of the shoulders.
  double leg(const BvhPose& pose) const;
  double trunk(const BvhPose& pose) const;
  // The figure's height in the file's units, from its legs and trunk.
  double height(const BvhPose& pose) const;

 private:
  const Bvh& bvh_;
  SourceJoints joints_;
  std::array<Eigen::Vector3d, kJoints> ends_;  // in the axes of the joint before
};

}  // namespace mocaplm
