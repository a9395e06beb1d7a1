// A .glb file that is changed and written again: its document, its binary chunk, and the tree of
// its nodes, all of it checked. Files come from strangers.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "common/json.h"
#include "motion/formats/glb_file.h"

namespace mocaplm {

struct GltfNode {
  std::string name;
  int parent = -1;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();

  Eigen::Affine3d local() const { return local(translation, rotation); }
  // With another place and turn.
  Eigen::Affine3d local(const Eigen::Vector3d& place, const Eigen::Quaterniond& turn) const {
    return Eigen::Translation3d(place) * turn * Eigen::Scaling(scale);
  }
};

struct GltfScene {
  std::string file;  // for messages
  Json document;
  std::string numbers;          // the buffer inside the file
  std::vector<GltfNode> nodes;  // as in the document
  std::vector<int> order;       // all nodes, each after its parent
};

// Throws DataError naming the file and the place: no .glb of version 2, cut off, no JSON, a tree
// that is none, numbers that are not finite, a first buffer that lies outside the file.
GltfScene read_gltf_scene(const std::filesystem::path& path);
// The same for the bytes of a .glb that came of `file`.
GltfScene parse_gltf_scene(const std::string& bytes, const std::string& file);

// The file again with an animation before its own ones. Views and accessors of `buffer` come after
// the file's; the animation must count them so. Nodes that it targets and that have a matrix get
// translation, rotation and scale in its place, as the specification asks for.
std::string with_animation(const GltfScene& scene, const Json& animation, const GlbBuffer& buffer);

}  // namespace mocaplm
