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
//   automatic  the first in which the figure stands: the zero pose, `axes`, frame 0, ...
//   (rest_pose.h) axes   `axes` says how each joint's own axes lie in a T-pose euler  `euler` gives
//   the rotation channels of the joints that are not zero in a T-pose frame  frame `frame` of the
//   motion is a T- or A-pose, at any heading
enum class TPose { automatic, axes, euler, frame };

struct RetargetMap {
  std::string scheme;                       // for messages: "cmu-daz", a map file's name
  std::array<std::string, kJoints> joints;  // source joint of each SMPL joint, "" for none
  TPose t_pose = TPose::automatic;
  std::map<std::string, JointAxes> axes;  // by source joint
  std::map<std::string, std::vector<double>>
      euler;  // by source joint: degrees, in its channels' order
  Eigen::Index frame = 0;
  std::string up, facing;      // "+y", "-z", ...; "" = found from the zero pose, else +y, +z
  std::optional<double> unit;  // metres per unit of the file
  bool align = true;           // turn limbs into the source's bone directions
  bool scheme_spine = false;   // two or three spine joints that are known to turn as SMPL's do
};

// The map for a skeleton: by its joint names where they are of a scheme that is known (our own SMPL
// names, CMU, Bandai-Namco, LAFAN, Mixamo, the classic Hips/LeftHip/LeftKnee), else as
// recognise_body finds it. Writes the map, or the best guess, to `write_to` unless that is "" or
// there. Throws DataError that says what is doubtful, lists the joints, and how to give a map.
RetargetMap detect_map(const Bvh& bvh, const std::string& file, const std::string& write_to = "");
// A map as its file's text.
std::string map_text(const RetargetMap& map);
// Reads a map file (docs/bvh-maps.md). Throws DataError naming the file and key.
RetargetMap load_map(const std::filesystem::path& path);

// SMPL joints that every map must name: pelvis, hips, knees, shoulders, elbows. Ankles and wrists
// may be End Sites.
const std::vector<int>& required_joints();

}  // namespace mocaplm
