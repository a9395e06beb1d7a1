// A tree of nodes, what is skinned to them and how they move: what there is of an .fbx, .gltf,
// .glb or .dae file once its format is gone. The program mocaplm-scene makes it with assimp, in a
// process of its own because assimp runs on files from strangers, and sends it as bytes.
//
// The bytes, little-endian, a text being its length (u32) and so many bytes, a matrix 16 f64 row
// after row, a count u32:
//   "mocaplm scene 1\n", metres per unit (f64), axes (3 x 3 f64), curves (u8), count of
//   meshes,
//   count of nodes, each: name, parent (i32), kind (u8), matrix
//   count of skins, each: mesh's node (u32), count of bones, each: node (u32), matrix
//   count of takes, each: name, begin and end (f64, seconds), count of tracks, each: node (u32),
//     count of positions, each: seconds (f64), 3 f32; of rotations, each: seconds, w x y z f32;
//     of scales, each: seconds, 3 f32
//   count of remarks, each: kind, text
// Whatever has another beginning is another version, and refused.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.h"
#include "motion/formats/formats.h"

namespace mocaplm {

// helper: one step on the way to the node of its own that hangs on it alone (an FBX bone has turns
// before and after the one that moves it); no joint, but its motion is that node's.
enum class SceneNodeKind { plain, mesh, camera, light, helper };

struct SceneNode {
  std::string name;  // unique
  int parent = -1;   // index of a node before this one; -1 for the root, which is the first
  SceneNodeKind kind = SceneNodeKind::plain;
  Eigen::Matrix4d local = Eigen::Matrix4d::Identity();  // to the parent, where nothing moves it
};

struct SceneBone {
  int node = 0;
  Eigen::Matrix4d from_mesh = Eigen::Matrix4d::Identity();  // of the bind pose, mesh to bone
};

struct SceneSkin {
  int mesh_node = 0;
  std::vector<SceneBone> bones;
};

template <class Value>
struct SceneKeys {
  std::vector<double> times;  // seconds, ascending
  std::vector<Value> values;
};

// A node's own translation, rotation and scale, each with at least one key.
struct SceneTrack {
  int node = 0;
  SceneKeys<Eigen::Vector3f> positions;
  SceneKeys<Eigen::Quaternionf> rotations;
  SceneKeys<Eigen::Vector3f> scales;
};

struct SceneTake {
  std::string name;
  double begin = 0, end = 0;  // of all keys, also of those that were left out because nothing moves
  std::vector<SceneTrack> tracks;
};

// A node, or a joint, that is there: not -1.
inline std::size_t node_index(int node) {
  return static_cast<std::size_t>(node);
}

struct Scene {
  double unit = 1;  // metres per unit of length, as the file says
  // From the file's world into one with Y up, as the file says.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  // The format may join keys by curves, which are not told here. Without it they are straight
  // lines.
  bool curves = false;
  std::size_t meshes = 0;
  std::vector<SceneNode> nodes;
  std::vector<SceneSkin> skins;
  std::vector<SceneTake> takes;
  std::vector<Remark> remarks;
};

// A file that could be read and holds no motion: a prop, or a character that stands.
class NoMotion : public DataError {
 public:
  using DataError::DataError;
};

std::string scene_bytes(const Scene& scene);

// Nothing is believed: throws DataError (naming `file`) for bytes that are cut off or left over, a
// parent that does not come first, a second root, a node that is not there, equal names, keys that
// go back in time, and numbers that are not finite or beyond 1e9.
Scene parse_scene(std::string_view bytes, const std::string& file);

}  // namespace mocaplm
