#include "motion/skeleton.h"

#include <algorithm>
#include <set>

#include "common/error.h"
#include "common/text.h"
#include "motion/rotation.h"

namespace mocaplm {

const std::array<int, kJoints>& joint_parents() {
  static const std::array<int, kJoints> parents = {-1, 0, 0, 0,  1,  2,  3,  4,  5,  6,  7,  8,
                                                   9,  9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21};
  return parents;
}

const std::array<std::string, kJoints>& joint_names() {
  static const std::array<std::string, kJoints> names = {
      "pelvis",     "left_hip",    "right_hip",    "spine1",      "left_knee",     "right_knee",
      "spine2",     "left_ankle",  "right_ankle",  "spine3",      "left_foot",     "right_foot",
      "neck",       "left_collar", "right_collar", "head",        "left_shoulder", "right_shoulder",
      "left_elbow", "right_elbow", "left_wrist",   "right_wrist", "left_hand",     "right_hand"};
  return names;
}

const std::array<int, kJoints>& mirrored_joints() {
  static const std::array<int, kJoints> mirrored = {0,  2,  1,  3,  5,  4,  6,  8,  7,  9,  11, 10,
                                                    12, 14, 13, 15, 17, 16, 19, 18, 21, 20, 23, 22};
  return mirrored;
}

const RestJoints& rest_joints() {
  static const RestJoints rest = [] {
    RestJoints joints;
    joints << -.0018, -.2233, .0282, .0677, -.3147, .0214, -.0695, -.3138, .0239, -.0043, -.1143,
        .0015, .1020, -.6899, .0169, -.1078, -.6964, .0150, .0012, .0209, .0026, .0884, -1.0879,
        -.0268, -.0920, -1.0948, -.0273, .0027, .0738, .0280, .1148, -1.1437, .0925, -.1174,
        -1.1429, .0960, -.0001, .2877, -.0149, .0815, .1955, -.0061, -.0791, .1926, -.0106, .0051,
        .3527, .0364, .1725, .2260, -.0150, -.1751, .2252, -.0197, .4321, .2132, -.0425, -.4288,
        .2119, -.0411, .6813, .2222, -.0437, -.6841, .2197, -.0467, .7653, .2140, -.0586, -.7687,
        .2136, -.0570;
    return joints;
  }();
  return rest;
}

const RestJoints& rest_joints(const Clip& clip) {
  return clip.body && clip.body->rest ? *clip.body->rest : rest_joints();
}

int joint_index(const std::string& name) {
  const auto& names = joint_names();
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

const std::vector<int>& thesis_joints() {
  static const std::vector<int> joints = {0, 1, 2, 4, 5, 7, 8, 16, 17, 18, 19, 20, 21};
  return joints;
}

const std::vector<std::pair<std::string, std::vector<int>>>& joint_groups() {
  static const std::vector<std::pair<std::string, std::vector<int>>> groups = {
      {"root", {0}},
      {"left_arm", {16, 18, 20}},
      {"right_arm", {17, 19, 21}},
      {"left_leg", {1, 4, 7}},
      {"right_leg", {2, 5, 8}},
      {"arms", {16, 17, 18, 19, 20, 21}},
      {"legs", {1, 2, 4, 5, 7, 8}},
      {"spine", {3, 6, 9}},
      {"thesis", thesis_joints()},
      {"all",
       {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23}}};
  return groups;
}

std::vector<int> parse_joints(const std::vector<std::string>& names) {
  std::set<int> chosen;
  for (const std::string& name : names) {
    std::vector<std::string> known(joint_names().begin(), joint_names().end());
    bool found = joint_index(name) >= 0;
    if (found) chosen.insert(joint_index(name));
    for (const auto& [group, joints] : joint_groups()) {
      known.push_back(group);
      if (group != name) continue;
      chosen.insert(joints.begin(), joints.end());
      found = true;
    }
    if (!found) throw UsageError("unknown joint \"" + name + "\"" + known_names(name, known));
  }
  return {chosen.begin(), chosen.end()};
}

std::array<Eigen::Matrix3d, kJoints> joint_world_rotations(const Clip& clip, Eigen::Index frame) {
  std::array<Eigen::Matrix3d, kJoints> world;
  for (int j = 0; j < kJoints; ++j) {
    const Eigen::Matrix3d local =
        matrix_from_axis_angle(clip.poses.row(frame).segment<3>(3 * j).transpose());
    const int parent = joint_parents()[static_cast<std::size_t>(j)];
    world[static_cast<std::size_t>(j)] =
        parent < 0 ? local : Eigen::Matrix3d(world[static_cast<std::size_t>(parent)] * local);
  }
  return world;
}

JointPositions joint_positions(const Clip& clip, Eigen::Index frame) {
  const auto world = joint_world_rotations(clip, frame);
  const RestJoints& rest = rest_joints(clip);
  JointPositions positions(kJoints, 3);
  positions.row(0) = rest.row(0) + clip.trans.row(frame);
  for (int j = 1; j < kJoints; ++j) {
    const int parent = joint_parents()[static_cast<std::size_t>(j)];
    const Eigen::Vector3d bone = (rest.row(j) - rest.row(parent)).transpose();
    positions.row(j) =
        positions.row(parent) + (world[static_cast<std::size_t>(parent)] * bone).transpose();
  }
  return positions;
}

}  // namespace mocaplm
