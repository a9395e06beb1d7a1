// Which nodes of a scene are a skeleton's joints, and how it stands at rest.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "motion/formats/scene.h"

namespace mocaplm {

struct SceneJoint {
  int node = 0;
  int parent = -1;                         // index of a joint before this one
  std::vector<Eigen::Vector3d> end_sites;  // in the world's axes, from the joint
};

struct SceneSkeleton {
  std::vector<SceneJoint> joints;  // parents first, one root
  // Of each of the scene's nodes: its place in the world at rest, in the file's own axes and unit.
  std::vector<Eigen::Matrix4d> rest;
  std::vector<int> chain;  // the joints' nodes and all above them, ascending
  bool bound = false;      // the rest pose is the skin's, which is not that of the nodes
};

// Joints are the nodes that carry a skin or are moved, cameras, lights and meshes that stand still
// left out, and the nodes between them; what hangs on the last joint of a limb is its End Site. The
// rest pose is the one in which the skin was bound where a skin says it (the nodes may stand in the
// first frame of a take), else that of the nodes. Empty when there is no skeleton. Throws DataError
// for more than 4,096 joints, or 256 of them one in the other.
SceneSkeleton scene_skeleton(const Scene& scene, const std::string& file);

// The places of all nodes, each its parent's times its own.
std::vector<Eigen::Matrix4d> scene_places(const Scene& scene);

}  // namespace mocaplm
