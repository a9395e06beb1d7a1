// What the retargeting tests share: bodies, rigs of named joints, and what "the same motion" means.
#pragma once

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/random.h"
#include "motion/formats/retarget.h"
#include "motion/formats/rig.h"
#include "motion/helpers.h"

namespace mocaplm {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();
// Elbows, shoulders, knees, hips: (joint, child).
const std::vector<std::pair<int, int>> kBones = {{16, 18}, {18, 20}, {17, 19}, {19, 21},
                                                 {1, 4},   {4, 7},   {2, 5},   {5, 8}};

inline Vector3d rest(int joint) {
  return rest_joints().row(joint).transpose();
}

// SMPL's rest joints, or another body: bones longer or shorter and a little tilted.
inline std::vector<Vector3d> body(Random* random) {
  std::vector<Vector3d> joints;
  for (int j = 0; j < kJoints; ++j) {
    const int parent = joint_parents()[static_cast<std::size_t>(j)];
    if (parent < 0 || !random) {
      joints.push_back(rest(j));
      continue;
    }
    Vector3d bone = rest(j) - rest(parent);
    bone = random->uniform(0.8, 1.2) * (bone + 0.1 * bone.norm() * random_direction(*random));
    joints.push_back(joints[static_cast<std::size_t>(parent)] + bone);
  }
  return joints;
}

using Names = std::vector<std::pair<int, std::string>>;  // SMPL joint -> name in the file

// A rig of the named joints; each hangs on its nearest named ancestor.
inline Rig rig_of(const Names& names, const std::vector<Vector3d>& positions) {
  Rig rig;
  for (int j = 0; j < kJoints; ++j)
    for (const auto& [joint, name] : names) {
      if (joint != j) continue;
      std::string parent;
      for (int p = joint_parents()[static_cast<std::size_t>(j)]; p >= 0 && parent.empty();
           p = joint_parents()[static_cast<std::size_t>(p)])
        for (const auto& [other, other_name] : names)
          if (other == p) parent = other_name;
      rig.joints.push_back({name, parent, j, positions[static_cast<std::size_t>(j)]});
    }
  return rig;
}

inline bool limb(int role) {
  for (const auto& bone : kBones)
    if (bone.first == role) return true;
  return role >= 20;  // the wrist is turned by the hand's direction, which differs
}

// Demands that `clip` shows the motion that `rig` wrote: rotations of joints that are not limbs,
// limb directions and the hips' place. With `exact` (SMPL's own body) also the limbs' rotations.
inline void expect_same_motion(const Clip& clip, const Rig& rig, const Clip& truth,
                               const Translations& roots, bool exact) {
  ASSERT_EQ(clip.frames(), truth.frames());
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const auto turned = joint_world_rotations(truth, t), ours = joint_world_rotations(clip, t);
    for (const RigJoint& joint : rig.joints) {
      const auto role = static_cast<std::size_t>(joint.role);
      if (exact ? joint.role >= 20 : limb(joint.role)) continue;
      EXPECT_LT((ours[role] - turned[role]).norm(), 1e-6) << joint.name << " frame " << t;
    }
    const auto source = rig.positions(turned, roots.row(t).transpose());
    const auto at = [&](int role) {  // the last joint of a role is the one with its name
      Vector3d found = Vector3d::Zero();
      for (std::size_t i = 0; i < rig.joints.size(); ++i)
        if (rig.joints[i].role == role) found = source[i];
      return found;
    };
    const JointPositions positions = joint_positions(clip, t);
    for (const auto& [joint, child] : kBones) {
      const Vector3d theirs = (at(child) - at(joint)).normalized();
      const Vector3d bone = (positions.row(child) - positions.row(joint)).transpose().normalized();
      EXPECT_LT((theirs - bone).norm(), 1e-6)
          << joint_names()[static_cast<std::size_t>(joint)] << " frame " << t;
    }
    const Vector3d hips = 0.5 * (positions.row(1) + positions.row(2)).transpose();
    EXPECT_LT((hips - 0.5 * (at(1) + at(2))).norm(), 1e-6) << "frame " << t;
  }
}

struct Motion {
  Clip clip;
  Translations roots;
};
inline Motion motion(Random& random, Eigen::Index frames = 4) {
  Motion m{random_clip(random, frames, 30, 1.0), {}};
  m.roots = m.clip.trans.rowwise() + rest_joints().row(0);
  return m;
}

inline std::string error_of(const Bvh& bvh, const BvhOptions& options = {}) {
  try {
    retarget_bvh(bvh, "walk.bvh", options);
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

}  // namespace mocaplm
