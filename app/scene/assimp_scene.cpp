#include "app/scene/assimp_scene.h"

#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "app/scene/files.h"
#include "app/scene/gltf.h"
#include "common/error.h"
#include "common/files.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr std::size_t kMaxNodes = 200000;
// In the names of the nodes that assimp makes of an FBX node's turns and pivots, when it is not
// told to fold them into one.
constexpr const char* kHelper = "_$AssimpFbx$_";

Eigen::Matrix4d matrix_of(const aiMatrix4x4& m) {
  Eigen::Matrix4d matrix;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column) matrix(row, column) = m[row][column];
  return matrix;
}

// FBX bones may have a turn after the animated one, whose inverse counts. assimp 5.2 forgets the
// inverse when it folds an FBX node into one. By node, what makes up for that:
struct PostRotation {
  Eigen::Matrix4d local;    // of the node where nothing moves it
  Eigen::Quaternionf turn;  // after the rotations of its track
};

std::unordered_map<std::string, PostRotation> post_rotations(const aiScene& unfolded) {
  const auto is = [](const aiNode* node, const std::string& part) {
    return std::string(node->mName.C_Str()).find(part) != std::string::npos;
  };
  struct Step {
    const aiNode* node;
    Eigen::Matrix4d before;  // the helpers above it that lead to the same node
    Eigen::Matrix3d post;
  };
  std::unordered_map<std::string, PostRotation> found;
  std::vector<Step> next = {
      {unfolded.mRootNode, Eigen::Matrix4d::Identity(), Eigen::Matrix3d::Identity()}};
  while (!next.empty()) {
    Step step = next.back();
    next.pop_back();
    const Eigen::Matrix4d own = matrix_of(step.node->mTransformation);
    step.before = step.before * own;
    if (is(step.node, std::string(kHelper) + "PostRotation")) step.post = own.topLeftCorner<3, 3>();
    if (!is(step.node, kHelper)) {
      if (!step.post.isIdentity(1e-6))
        found[step.node->mName.C_Str()] = {
            step.before, Eigen::Quaternionf((step.post * step.post).cast<float>())};
      step.before.setIdentity();
      step.post.setIdentity();
    }
    for (unsigned c = 0; c < step.node->mNumChildren; ++c)
      next.push_back({step.node->mChildren[c], step.before, step.post});
  }
  return found;
}

Eigen::Vector3f value_of(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}
Eigen::Quaternionf value_of(const aiQuaternion& q) {
  return {q.w, q.x, q.y, q.z};
}

bool same(const aiVector3D& a, const aiVector3D& b) {
  return a == b;
}
bool same(const aiQuaternion& a, const aiQuaternion& b) {
  return a == b;
}

class Reader {
 public:
  Reader(const aiScene& scene, const std::string& file) : scene_(scene), file_(file) {}

  void read(Scene& out) {
    if (scene_.mRootNode == nullptr) fail("has no nodes");
    out.meshes = scene_.mNumMeshes;
    nodes(out);
    skins(out);
    for (unsigned i = 0; i < scene_.mNumAnimations; ++i)
      out.takes.push_back(take(*scene_.mAnimations[i]));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw DataError(in_file(file_), what); }

  // Depth first, without recursion: how deep a file goes is for others to judge.
  void nodes(Scene& out) {
    std::unordered_set<std::string> cameras, lights;
    for (unsigned i = 0; i < scene_.mNumCameras; ++i)
      cameras.insert(scene_.mCameras[i]->mName.C_Str());
    for (unsigned i = 0; i < scene_.mNumLights; ++i)
      lights.insert(scene_.mLights[i]->mName.C_Str());
    std::vector<std::pair<const aiNode*, int>> next = {{scene_.mRootNode, -1}};
    while (!next.empty()) {
      const auto [from, parent] = next.back();
      next.pop_back();
      const int index = static_cast<int>(out.nodes.size());
      if (out.nodes.size() == kMaxNodes)
        fail("has more than " + std::to_string(kMaxNodes) + " nodes");
      SceneNode node;
      const std::string given = from->mName.C_Str();
      node.name = given.empty() ? "node" : given;
      for (int n = 2; !index_.emplace(node.name, index).second; ++n) {
        doubled_.insert(given);
        node.name = given + "." + std::to_string(n);
      }
      node.parent = parent;
      node.kind = given.find(kHelper) != given.npos ? SceneNodeKind::helper
                  : cameras.count(given) > 0        ? SceneNodeKind::camera
                  : lights.count(given) > 0         ? SceneNodeKind::light
                  : from->mNumMeshes > 0            ? SceneNodeKind::mesh
                                                    : SceneNodeKind::plain;
      node.local = matrix_of(from->mTransformation);
      out.nodes.push_back(node);
      for (unsigned m = 0; m < from->mNumMeshes; ++m) mesh_nodes_.emplace(from->mMeshes[m], index);
      for (unsigned c = from->mNumChildren; c-- > 0;) next.emplace_back(from->mChildren[c], index);
    }
  }

  // The node of a name; -1 for none.
  int find(const aiString& given, const char* what) const {
    const std::string name = given.C_Str();
    if (doubled_.count(name) > 0)
      fail("has several nodes named \"" + name + "\", and " + what +
           " names one of them; give them names of their own");
    const auto found = index_.find(name);
    return found == index_.end() ? -1 : found->second;
  }

  void skins(Scene& out) const {
    for (unsigned i = 0; i < scene_.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_.mMeshes[i];
      const auto at = mesh_nodes_.find(i);
      if (at == mesh_nodes_.end()) continue;
      SceneSkin skin;
      skin.mesh_node = at->second;
      for (unsigned b = 0; b < mesh.mNumBones; ++b) {
        const int node = find(mesh.mBones[b]->mName, "the skin");
        if (node >= 0) skin.bones.push_back({node, matrix_of(mesh.mBones[b]->mOffsetMatrix)});
      }
      if (!skin.bones.empty()) out.skins.push_back(std::move(skin));
    }
  }

  // Keys in the order of time; those of a value that never changes are one.
  template <class Out, class Key>
  void keys(SceneKeys<Out>& out, const Key* from, unsigned count, double ticks, SceneTake& take) {
    std::vector<Key> sorted(from, from + count);
    for (const Key& key : sorted)
      if (!std::isfinite(key.mTime)) fail("has a key at a time that is not finite");
    const auto earlier = [](const Key& a, const Key& b) { return a.mTime < b.mTime; };
    if (!std::is_sorted(sorted.begin(), sorted.end(), earlier))
      std::stable_sort(sorted.begin(), sorted.end(), earlier);
    if (sorted.size() > 1 && sorted.front().mTime < sorted.back().mTime) {
      const double begin = sorted.front().mTime / ticks, end = sorted.back().mTime / ticks;
      take.begin = timed_ ? std::min(take.begin, begin) : begin;
      take.end = timed_ ? std::max(take.end, end) : end;
      timed_ = true;
    }
    const bool still = std::all_of(sorted.begin(), sorted.end(), [&](const Key& key) {
      return same(key.mValue, sorted.front().mValue);
    });
    if (still) sorted.resize(1);
    for (const Key& key : sorted) {
      out.times.push_back(key.mTime / ticks);
      out.values.push_back(value_of(key.mValue));
    }
  }

  SceneTake take(const aiAnimation& animation) {
    SceneTake take;
    take.name = animation.mName.C_Str();
    timed_ = false;
    const double ticks = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 25;
    for (unsigned i = 0; i < animation.mNumChannels; ++i) {
      const aiNodeAnim& channel = *animation.mChannels[i];
      const int node = find(channel.mNodeName, "an animation");
      if (node < 0) continue;
      SceneTrack track;
      track.node = node;
      // What has no keys of its own stays as the node has it.
      aiVectorKey scale, position;
      aiQuatKey rotation;
      scene_.mRootNode->FindNode(channel.mNodeName)
          ->mTransformation.Decompose(scale.mValue, rotation.mValue, position.mValue);
      const auto add = [&](auto& out, const auto* from, unsigned count, const auto& otherwise) {
        count > 0 ? keys(out, from, count, ticks, take) : keys(out, &otherwise, 1, ticks, take);
      };
      add(track.positions, channel.mPositionKeys, channel.mNumPositionKeys, position);
      add(track.rotations, channel.mRotationKeys, channel.mNumRotationKeys, rotation);
      add(track.scales, channel.mScalingKeys, channel.mNumScalingKeys, scale);
      take.tracks.push_back(std::move(track));
    }
    return take;
  }

  const aiScene& scene_;
  const std::string& file_;
  std::unordered_map<std::string, int> index_;
  std::unordered_set<std::string> doubled_;
  std::unordered_map<unsigned, int> mesh_nodes_;
  bool timed_ = false;
};

// A number of the file's global settings, whatever its type.
double setting(const aiScene& scene, const char* key, double otherwise) {
  const aiMetadata* all = scene.mMetaData;
  if (all == nullptr) return otherwise;
  for (unsigned i = 0; i < all->mNumProperties; ++i) {
    if (all->mKeys[i] != aiString(key)) continue;
    const aiMetadataEntry& entry = all->mValues[i];
    if (entry.mType == AI_INT32) return *static_cast<const int32_t*>(entry.mData);
    if (entry.mType == AI_UINT64)
      return static_cast<double>(*static_cast<const uint64_t*>(entry.mData));
    if (entry.mType == AI_FLOAT) return *static_cast<const float*>(entry.mData);
    if (entry.mType == AI_DOUBLE) return *static_cast<const double*>(entry.mData);
  }
  return otherwise;
}

// An FBX says which of its axes point right, up and to the front, and how many centimetres its unit
// has.
void fbx_settings(const aiScene& from, Scene& out) {
  const double centimetres = setting(from, "UnitScaleFactor", 1);
  if (centimetres > 1e-4 && centimetres < 1e8) out.unit = centimetres / 100;
  const char* names[] = {"CoordAxis", "UpAxis", "FrontAxis"};
  const char* signs[] = {"CoordAxisSign", "UpAxisSign", "FrontAxisSign"};
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  for (int row = 0; row < 3; ++row) {
    const auto axis = static_cast<int>(setting(from, names[row], row));
    if (axis >= 0 && axis < 3) axes(row, axis) = setting(from, signs[row], 1) < 0 ? -1 : 1;
  }
  if (std::abs(axes.determinant() - 1) < 1e-9) out.axes = axes;
}

std::string name_of(const std::string& bytes, const std::string& file) {
  if (bytes.rfind("glTF", 0) == 0) return "scene.glb";
  if (bytes.rfind("Kaydara FBX Binary", 0) == 0) return "scene.fbx";
  const std::string head = bytes.substr(0, 4096);
  if (head.find("<COLLADA") != head.npos) return "scene.dae";
  const std::size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first != head.npos && head[first] == '{') return "scene.gltf";
  if (head.find("FBX") != head.npos) return "scene.fbx";
  throw DataError(in_file(file), "is neither an FBX, nor a glTF, nor a COLLADA file");
}

void set_up(Assimp::Importer& importer) {
  const auto set = [&](const char* key, bool value) { importer.SetPropertyBool(key, value); };
  set(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  set(AI_CONFIG_IMPORT_FBX_OPTIMIZE_EMPTY_ANIMATION_CURVES, false);
  set(AI_CONFIG_IMPORT_FBX_READ_ALL_GEOMETRY_LAYERS, false);
  set(AI_CONFIG_IMPORT_FBX_READ_MATERIALS, false);
  set(AI_CONFIG_IMPORT_FBX_READ_TEXTURES, false);
  set(AI_CONFIG_IMPORT_FBX_STRICT_MODE, false);
  set(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
}

}  // namespace

namespace {

void correct(Scene& scene, const std::unordered_map<std::string, PostRotation>& by) {
  if (by.empty()) return;
  const auto of = [&](std::size_t node) { return by.find(scene.nodes[node].name); };
  for (std::size_t i = 0; i < scene.nodes.size(); ++i)
    if (of(i) != by.end()) scene.nodes[i].local = of(i)->second.local;
  for (SceneTake& take : scene.takes)
    for (SceneTrack& track : take.tracks) {
      const auto found = of(static_cast<std::size_t>(track.node));
      if (found == by.end()) continue;
      for (Eigen::Quaternionf& turn : track.rotations.values) turn = turn * found->second.turn;
    }
}

}  // namespace

Scene read_with_assimp(const fs::path& path) {
  const std::string file = path.string();
  std::string bytes = read_file(path);
  const std::string name = name_of(bytes, file);
  const bool gltf = name != "scene.fbx" && name != "scene.dae";
  Scene out;
  out.curves = !gltf;
  if (gltf) bytes = plain_gltf(bytes, file, out.remarks);
  const auto load = [&](bool readable_names) {
    Assimp::Importer importer;
    set_up(importer);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, readable_names);
    auto* files =
        new SceneFiles(name, bytes, name == "scene.gltf" ? path.parent_path() : fs::path());
    importer.SetIOHandler(files);  // which owns it
    const aiScene* scene = importer.ReadFile(name, 0);
    if (scene == nullptr)
      throw DataError(
          in_file(file),
          files->missing().empty()
              ? std::string("assimp cannot read it: ") + importer.GetErrorString()
              : "needs the file \"" + files->missing() + "\", which is not in its folder");
    if (name == "scene.fbx") fbx_settings(*scene, out);
    Reader(*scene, file).read(out);
    if (name != "scene.fbx" || bytes.find("PostRotation") == bytes.npos || out.takes.empty())
      return;
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
    if (const aiScene* unfolded = importer.ReadFile(name, 0))
      correct(out, post_rotations(*unfolded));
  };
  const Scene before = out;
  try {
    load(true);
  } catch (const DataError&) {
    if (name != "scene.dae") throw;
    out = before;
    load(false);  // by the ids, which a COLLADA file has once each
  }
  return out;
}

}  // namespace mocaplm
