// Landmarks of a clip as postures; emulator/body.h makes clips of postures again.
#pragma once

#include <string>
#include <vector>

#include "emulator/sequence.h"
#include "motion/clip.h"

namespace mocaplm {

// Landmarks in a tree, each but the root with a parent that comes before it. A limb is a landmark
// with its parent; limbs are in the landmarks' order without the root: limb i is landmark i + 1.
struct LandmarkTree {
  std::vector<std::string> names;  // n
  std::vector<int> parents;        // n; -1 for landmark 0
  Eigen::Index limbs() const { return static_cast<Eigen::Index>(names.size()) - 1; }
};

// Throws UsageError unless the tree is as above, with 2 landmarks or more.
void check_tree(const LandmarkTree& tree);
// SMPL's joints, all or some: the parent is then the nearest ancestor among them. The pelvis is
// always one of them. Throws UsageError for fewer than 2.
LandmarkTree smpl_landmarks(const std::vector<int>& joints = {});

// The unit directions of all limbs of landmark positions (T * n, 3), frame after frame. Throws
// DataError naming frame and landmark where a limb has no length or a position is not finite.
PostureSequence posture_sequence(
    const LandmarkTree& tree,
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& positions, const Place& place);

// What of the direction that a person faces is taken away: nothing ("keep"), that of the first
// frame ("start"), the mean one ("mean"), or that of every frame ("every"). Facing is the direction
// across the hips and shoulders, turned by 90 degrees, on the ground.
const std::vector<std::string>& heading_names();

// Forward kinematics of every frame, then posture_sequence. `tree` is one that smpl_landmarks
// makes.
PostureSequence clip_postures(const Clip& clip, const LandmarkTree& tree,
                              const std::string& heading);

}  // namespace mocaplm
