#include "motion/formats/character.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "common/error.h"
#include "common/text.h"
#include "motion/floor.h"
#include "motion/formats/bvh.h"
#include "motion/formats/glb_file.h"
#include "motion/formats/gltf_scene.h"
#include "motion/formats/out_scheme.h"
#include "motion/formats/rest_pose.h"
#include "motion/formats/retarget_map.h"
#include "motion/formats/scene_process.h"
#include "motion/formats/skeletons.h"
#include "motion/formats/source_figure.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

using Quaternions = std::array<Eigen::Quaterniond, kJoints>;

// Joints whose bones are laid as SMPL's lie at rest, with the joint at the bone's end.
constexpr std::size_t kLaidBones[][2] = {{16, 18}, {18, 20}, {17, 19}, {19, 21},
                                         {1, 4},   {4, 7},   {2, 5},   {5, 8}};

// SMPL's joints by VRM's names for them.
std::map<std::string, std::size_t> vrm_joints() {
  std::map<std::string, std::size_t> joints;
  for (const OutJoint& joint : out_skeleton(Clip(), OutScheme::vrm).joints)
    joints[joint.name] = static_cast<std::size_t>(joint.smpl);
  return joints;
}

// What VRM 1.0 or 0.x says about the file's nodes; all -1 where it says nothing.
SourceJoints vrm_nodes(const GltfScene& scene) {
  SourceJoints nodes;
  nodes.fill(-1);
  const auto joints = vrm_joints();
  const auto take = [&](const std::string& bone, const Json& entry) {
    const auto joint = joints.find(bone);
    if (joint == joints.end() || !entry.is_object() || !entry.contains("node")) return;
    const Json& node = entry["node"];
    if (node.is_number_unsigned() && node.get<std::size_t>() < scene.nodes.size())
      nodes[joint->second] = node.get<int>();
  };
  const auto bones = [&](const char* extension) -> Json {
    const Json* at = &scene.document;
    for (const char* key : {"extensions", extension, "humanoid", "humanBones"}) {
      if (!at->is_object() || !at->contains(key)) return nullptr;
      at = &(*at)[key];
    }
    return *at;
  };
  const Json first = bones("VRMC_vrm"), old = bones("VRM");
  if (first.is_object())
    for (const auto& [bone, entry] : first.items()) take(bone, entry);
  else if (old.is_array())
    for (const Json& entry : old)
      if (entry.is_object() && entry.contains("bone") && entry["bone"].is_string())
        take(entry["bone"], entry);
  return nodes;
}

// The nodes that can be bones: those that a skin names and all above them; without skins all.
std::set<int> bone_nodes(const GltfScene& scene) {
  std::set<int> bones;
  for (const Json& skin : scene.document.value("skins", Json::array()))
    if (skin.is_object() && skin.contains("joints") && skin["joints"].is_array())
      for (const Json& joint : skin["joints"])
        if (joint.is_number_unsigned() && joint.get<std::size_t>() < scene.nodes.size())
          for (int node = joint.get<int>(); node >= 0 && bones.insert(node).second;)
            node = scene.nodes[static_cast<std::size_t>(node)].parent;
  if (bones.empty()) bones.insert(scene.order.begin(), scene.order.end());
  return bones;
}

}  // namespace

struct Character::Parts {
  GltfScene scene;
  std::vector<Eigen::Affine3d> rest;          // of each node, in the world
  std::vector<Eigen::Quaterniond> rest_turn;  // without the scales
  SourceJoints nodes;                         // of SMPL's joints
  std::vector<int> smpl;                      // of each node, -1 for none
  Eigen::Matrix3d turn;                       // the file's world into ours

  Eigen::Vector3d place(std::size_t joint) const {  // at rest, in our world
    return turn * rest[static_cast<std::size_t>(nodes[joint])].translation();
  }
  Eigen::Vector3d middle(std::size_t a, std::size_t b) const { return 0.5 * (place(a) + place(b)); }
  double leg() const {
    return 0.5 * ((place(1) - place(4)).norm() + (place(4) - place(7)).norm() +
                  (place(2) - place(5)).norm() + (place(5) - place(8)).norm());
  }

  void pose_at_rest();
  Bvh as_bvh() const;
  void recognise();
  Quaternions laid_as(const RestJoints& body) const;
  double ankles() const;
};

// World transforms of all nodes. Turns go down the tree beside them: a scale that is not the same
// in all directions would bend them.
void Character::Parts::pose_at_rest() {
  rest.resize(scene.nodes.size());
  rest_turn.resize(scene.nodes.size());
  for (const int index : scene.order) {
    const auto i = static_cast<std::size_t>(index);
    const GltfNode& node = scene.nodes[i];
    rest[i] = node.local();
    rest_turn[i] = node.rotation;
    if (node.parent < 0) continue;
    const auto p = static_cast<std::size_t>(node.parent);
    rest[i] = rest[p] * rest[i];
    rest_turn[i] = rest_turn[p] * rest_turn[i];
  }
}

// The bones as a .bvh skeleton whose zero pose is the rest pose, with the world's axes; joint i is
// the i-th of bone_nodes in the tree's order.
Bvh Character::Parts::as_bvh() const {
  const std::set<int> bones = bone_nodes(scene);
  Bvh bvh;
  std::map<int, int> joint_of;
  std::set<std::string> taken;
  std::size_t roots = 0;
  for (const int index : scene.order)
    if (bones.count(index) && !bones.count(scene.nodes[static_cast<std::size_t>(index)].parent))
      ++roots;
  if (roots > 1) {  // one root for all of them
    bvh.joints.emplace_back();
    bvh.joints.back().name = "mocaplm_root";
  }
  for (const int index : scene.order) {
    if (!bones.count(index)) continue;
    const auto i = static_cast<std::size_t>(index);
    BvhJoint joint;
    joint.name = scene.nodes[i].name;
    if (joint.name.empty() || !taken.insert(joint.name).second) {
      joint.name += "#" + std::to_string(index);
      taken.insert(joint.name);
    }
    const auto parent = joint_of.find(scene.nodes[i].parent);
    joint.parent = parent != joint_of.end() ? parent->second : roots > 1 ? 0 : -1;
    joint.offset = rest[i].translation();
    if (parent != joint_of.end())
      joint.offset -= rest[static_cast<std::size_t>(parent->first)].translation();
    joint_of[index] = static_cast<int>(bvh.joints.size());
    bvh.joints.push_back(joint);
  }
  bvh.fps = 30;
  bvh.frame_time = 1.0 / 30;
  bvh.values.resize(1, 0);
  return bvh;
}

void Character::Parts::recognise() {
  const Bvh bvh = as_bvh();
  std::map<std::string, int> node_of;  // by the skeleton's names
  {
    const std::set<int> bones = bone_nodes(scene);
    std::size_t joint = bvh.joints.front().name == "mocaplm_root" ? 1 : 0;
    for (const int index : scene.order)
      if (bones.count(index)) node_of[bvh.joints[joint++].name] = index;
  }
  RetargetMap map;
  const SourceJoints said = vrm_nodes(scene);
  if (std::any_of(said.begin(), said.end(), [](int node) { return node >= 0; })) {
    map.scheme = "vrm";
    for (const auto& [name, node] : node_of)
      for (std::size_t j = 0; j < kJoints; ++j)
        if (said[j] == node) map.joints[j] = name;
  } else {
    map = detect_map(bvh, scene.file);
  }
  const SourceFigure figure(bvh, map, scene.file);  // refuses where a bone is missing
  for (const int end : {7, 8, 20, 21})
    if (!figure.has(end))
      throw DataError(in_file(scene.file),
                      "has no bone for " + joint_names()[static_cast<std::size_t>(end)]);
  map.axes.clear();
  const RestPose standing = find_rest_pose(bvh, map, figure, scene.file);
  if (!standing.zero)
    throw DataError(in_file(scene.file),
                    "does not stand in a T- or A-pose when nothing moves it: save it in its rest "
                    "pose");
  turn = standing.front;
  nodes.fill(-1);
  smpl.assign(scene.nodes.size(), -1);
  for (std::size_t j = 0; j < 22; ++j) {  // hands' joints are fingers there
    if (map.joints[j].empty()) continue;
    nodes[j] = node_of.at(map.joints[j]);
    smpl[static_cast<std::size_t>(nodes[j])] = static_cast<int>(j);
  }
  for (const int node : nodes)
    for (int n = node; n >= 0; n = scene.nodes[static_cast<std::size_t>(n)].parent) {
      const Eigen::Vector3d& scale = scene.nodes[static_cast<std::size_t>(n)].scale;
      if (!(scale.minCoeff() > 0 && scale.maxCoeff() < 1.001 * scale.minCoeff()))
        throw DataError(in_file(scene.file),
                        "node \"" + scene.nodes[static_cast<std::size_t>(n)].name +
                            "\" has a scale that is not the same in all directions: apply it in "
                            "the program that the file comes from");
    }
}

// For each joint the smallest turn from the direction of the character's bone to that of the
// body's.
Quaternions Character::Parts::laid_as(const RestJoints& body) const {
  Quaternions laid;
  laid.fill(Eigen::Quaterniond::Identity());
  for (const auto& limb : kLaidBones) {
    const auto a = static_cast<Eigen::Index>(limb[0]), b = static_cast<Eigen::Index>(limb[1]);
    laid[limb[0]] =
        shortest_rotation(place(limb[1]) - place(limb[0]), (body.row(b) - body.row(a)).transpose());
  }
  laid[20] = laid[18];
  laid[21] = laid[19];
  return laid;
}

// How high the ankles are over the soles at rest. Characters stand at height 0; of one that does
// not the toes say where.
double Character::Parts::ankles() const {
  const double ankle = 0.5 * (place(7).y() + place(8).y());
  if (ankle > 0 && ankle < 0.35 * leg()) return ankle;
  if (nodes[10] < 0 || nodes[11] < 0) return 0.1 * leg();
  return ankle - std::min(place(10).y(), place(11).y()) + 0.04 * leg();
}

namespace {

// assimp writes colours twice: as glTF has them, and as an extension for an FBX's shininess, which
// Blender prefers and shows grey.
void drop_specular_glossiness(Json& document) {
  const char* const name = "KHR_materials_pbrSpecularGlossiness";
  if (document.contains("materials"))
    for (Json& material : document["materials"])
      if (material.is_object() && material.contains("extensions"))
        material["extensions"].erase(name);
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!document.contains(list)) continue;
    Json kept = Json::array();
    for (const Json& extension : document[list])
      if (extension != name) kept.push_back(extension);
    if (kept.empty())
      document.erase(list);
    else
      document[list] = kept;
  }
}

}  // namespace

Character::Character(const std::filesystem::path& file) : parts_(std::make_unique<Parts>()) {
  const bool fbx = lower(file.extension().string()) == ".fbx";
  parts_->scene =
      fbx ? parse_gltf_scene(read_character_glb(file), file.string()) : read_gltf_scene(file);
  if (fbx) drop_specular_glossiness(parts_->scene.document);
  parts_->pose_at_rest();
  parts_->recognise();
}
Character::~Character() = default;
Character::Character(Character&&) noexcept = default;
Character& Character::operator=(Character&&) noexcept = default;

std::vector<std::pair<std::string, std::string>> Character::bones() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const int node = parts_->nodes[j];
    all.emplace_back(joint_names()[j],
                     node < 0 ? "" : parts_->scene.nodes[static_cast<std::size_t>(node)].name);
  }
  return all;
}

double Character::scale(const Clip& clip) const {
  const RestJoints& body = rest_joints(clip);
  const auto bone = [&](int a, int b) { return (body.row(a) - body.row(b)).norm(); };
  return parts_->leg() / (0.5 * (bone(1, 4) + bone(4, 7) + bone(2, 5) + bone(5, 8)));
}

std::string Character::animated(const Clip& clip) const {
  const Parts& parts = *parts_;
  if (clip.frames() > kMaxGlbFrames)
    throw DataError(in_file(clip.name),
                    "has " + std::to_string(clip.frames()) + " frames, more than the " +
                        std::to_string(kMaxGlbFrames) + " of a .glb: write a part");
  const RestJoints& body = rest_joints(clip);
  const Quaternions laid = parts.laid_as(body);
  const double size = scale(clip);
  const double ankle =
      0.5 * (body(7, 1) + body(8, 1)) - std::min(body(10, 1), body(11, 1)) + kSoleBelowFoot;
  const double lift = parts.ankles() - size * ankle;
  const Eigen::Vector3d hips_from_pelvis = parts.middle(1, 2) - parts.place(0);
  const Eigen::Quaterniond turn = quaternion_from_matrix(parts.turn), back = turn.conjugate();

  std::map<std::size_t, std::vector<float>> turns;
  std::vector<float> places, times;
  std::vector<Eigen::Affine3d> world(parts.scene.nodes.size());
  std::vector<Eigen::Quaterniond> world_turn(parts.scene.nodes.size());
  std::vector<Eigen::Quaterniond> before(parts.scene.nodes.size(), Eigen::Quaterniond::Identity());
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    times.push_back(static_cast<float>(static_cast<double>(t) / clip.fps));
    const auto joints = joint_world_rotations(clip, t);
    const JointPositions at = joint_positions(clip, t);
    for (const int index : parts.scene.order) {
      const auto i = static_cast<std::size_t>(index);
      const GltfNode& node = parts.scene.nodes[i];
      const bool top = node.parent < 0;
      const auto p = static_cast<std::size_t>(std::max(node.parent, 0));
      Eigen::Quaterniond local = node.rotation;
      Eigen::Vector3d place = node.translation;
      if (parts.smpl[i] >= 0) {
        const auto j = static_cast<std::size_t>(parts.smpl[i]);
        const Eigen::Quaterniond moved = quaternion_from_matrix(joints[j]) * laid[j];
        const Eigen::Quaterniond wanted = back * moved * turn * parts.rest_turn[i];
        local = ((top ? wanted : world_turn[p].conjugate() * wanted)).normalized();
        if (local.dot(before[i]) < 0) local.coeffs() = -local.coeffs();
        before[i] = local;
        for (int k = 0; k < 4; ++k) turns[i].push_back(static_cast<float>(local.coeffs()[k]));
        if (j == 0) {
          Eigen::Vector3d hips = size * 0.5 * (at.row(1) + at.row(2)).transpose();
          hips.y() += lift;
          place = back * (hips - moved * hips_from_pelvis);
          if (!top) place = world[p].inverse() * place;
          for (int axis = 0; axis < 3; ++axis) places.push_back(static_cast<float>(place[axis]));
        }
      }
      world[i] = node.local(place, local);
      world_turn[i] = local;
      if (top) continue;
      world[i] = world[p] * world[i];
      world_turn[i] = world_turn[p] * local;
    }
  }

  GlbBuffer buffer;
  Json samplers = Json::array(), channels = Json::array();
  const int input = buffer.add(times, 1, kFloat);
  const auto first = parts.scene.document.value("accessors", Json::array()).size();
  const auto channel = [&](std::size_t node, const char* path, int output) {
    channels.push_back(
        {{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers.push_back({{"input", first + static_cast<std::size_t>(input)},
                        {"output", first + static_cast<std::size_t>(output)},
                        {"interpolation", "LINEAR"}});
  };
  channel(static_cast<std::size_t>(parts.nodes[0]), "translation", buffer.add(places, 3, kFloat));
  for (const auto& [node, rotations] : turns)
    channel(node, "rotation", buffer.add(rotations, 4, kFloat));
  Json extras = {{"fps", clip.fps}};
  if (!clip.labels.empty()) extras["labels"] = clip.labels;
  return with_animation(parts.scene,
                        {{"name", clip.name.empty() ? "motion" : clip.name},
                         {"channels", channels},
                         {"samplers", samplers},
                         {"extras", extras}},
                        buffer);
}

}  // namespace mocaplm
