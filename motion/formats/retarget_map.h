// Which joint of a skeleton is which of SMPL's, and how that skeleton stands in a T-pose.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "motion/formats/bvh.h"
#include "motion/skeleton.h"

namespace mocaplm {

// Local x and y axes of a joint as they lie in a T-pose that faces +Z, left = +X, up = +Y (z = x
// cross y).
struct JointAxes {
  Eigen::Vector3d x, y;
};

// Where the T-pose comes from.
//   zero   all rotations zero is a T-pose (or A-pose: limbs are aligned by their directions anyway)
//   axes   `axes` says how each joint's own axes lie in a T-pose
//   euler  `euler` gives the rotation channels of the joints that are not zero in a T-pose
//   frame  frame `frame` of the motion is a T-pose, at any heading
enum class TPose { zero, axes, euler, frame };

struct RetargetMap {
  std::string scheme;                       // for messages: "cmu-daz", a map file's name
  std::array<std::string, kJoints> joints;  // source joint of each SMPL joint, "" for none
  TPose t_pose = TPose::zero;
  std::map<std::string, JointAxes> axes;  // by source joint
  std::map<std::string, std::vector<double>>
      euler;  // by source joint: degrees, in its channels' order
  Eigen::Index frame = 0;
  std::string up, facing;      // "+y", "-z", ...; "" = found from the zero pose, else +y, +z
  std::optional<double> unit;  // metres per unit of the file
  bool align = true;           // turn limbs into the source's bone directions
};

// The map for a skeleton whose joint names are known: our own SMPL names, CMU (DAZ-friendly and
// original), Bandai-Namco, LAFAN and Mixamo, and the classic Hips/LeftHip/LeftKnee. Throws
// DataError that lists the joints, what was not matched in the nearest scheme, and how to write a
// map.
RetargetMap detect_map(const Bvh& bvh, const std::string& file);
// Reads a map file (docs/bvh-maps.md). Throws DataError naming the file and key.
RetargetMap load_map(const std::filesystem::path& path);

// SMPL joints that every map must name: pelvis, hips, knees, ankles, shoulders, elbows, wrists.
const std::vector<int>& required_joints();
// True when the zero pose of the mapped joints stands upright with the legs below the pelvis.
bool zero_pose_stands(const Bvh& bvh, const RetargetMap& map);

}  // namespace mocaplm
