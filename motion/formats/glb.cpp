#include "motion/formats/glb.h"

#include <cstdint>
#include <vector>

#include "common/error.h"
#include "common/files.h"
#include "common/json.h"
#include "motion/body_mesh.h"
#include "motion/formats/glb_file.h"
#include "motion/formats/skeletons.h"

namespace mocaplm {

namespace {

constexpr const char* kVrmAnimation = "VRMC_vrm_animation";

std::vector<float> floats(const MeshPoints& points) {
  return {points.data(), points.data() + points.size()};
}

Json joint_nodes(const OutSkeleton& skeleton) {
  Json nodes = Json::array();
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const OutJoint& joint = skeleton.joints[i];
    Eigen::Vector3d bone = joint.rest;
    if (joint.parent < 0)
      bone.y() += skeleton.lift;
    else
      bone -= skeleton.joints[static_cast<std::size_t>(joint.parent)].rest;
    Json node = {{"name", joint.name}, {"translation", {bone.x(), bone.y(), bone.z()}}};
    Json children = Json::array();
    for (std::size_t child = i + 1; child < skeleton.joints.size(); ++child)
      if (skeleton.joints[child].parent == static_cast<int>(i)) children.push_back(child);
    if (!children.empty()) node["children"] = children;
    nodes.push_back(node);
  }
  return nodes;
}

// The figure in the skeleton's rest pose.
Json mesh_primitive(const OutSkeleton& skeleton, const Clip& clip, GlbBuffer& buffer) {
  const BodyMesh& mesh = body_mesh();
  MeshPoints positions = mesh.positions, normals = mesh.normals;
  if (skeleton.scheme != OutScheme::smpl || (clip.body && clip.body->rest))
    pose_body(out_rest_pose(skeleton, clip), 0, positions, normals);
  positions.col(1).array() += static_cast<float>(skeleton.lift);
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (const BodyMesh::Carried& carried : mesh.carried) {
    const auto node = [&](std::size_t i) {
      return static_cast<std::uint8_t>(skeleton.of_smpl[carried.joints[i]]);
    };
    std::array<float, 2> weight = carried.weights;
    std::array<std::uint8_t, 2> joint = {node(0), node(1)};
    // Where one joint stands for both it has all; what weighs nothing names joint 0.
    if (joint[0] == joint[1]) weight = {weight[0] + weight[1], 0};
    if (weight[1] == 0) joint[1] = 0;
    joints.insert(joints.end(), {joint[0], joint[1], 0, 0});
    weights.insert(weights.end(), {weight[0], weight[1], 0, 0});
  }
  return {{"attributes",
           {{"POSITION", buffer.add(floats(positions), 3, kFloat, kVertices)},
            {"NORMAL", buffer.add(floats(normals), 3, kFloat, kVertices)},
            {"JOINTS_0", buffer.add(joints, 4, kUint8, kVertices)},
            {"WEIGHTS_0", buffer.add(weights, 4, kFloat, kVertices)}}},
          {"indices", buffer.add(mesh.triangles, 1, kUint16, kIndices)},
          {"material", 0}};
}

// The bind pose has no rotations: each matrix, column after column, only takes the joint to the
// origin.
Json skin(const OutSkeleton& skeleton, GlbBuffer& buffer) {
  std::vector<float> matrices;
  Json joints = Json::array();
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.topRightCorner<3, 1>() = -skeleton.joints[i].rest.cast<float>();
    inverse(1, 3) -= static_cast<float>(skeleton.lift);
    matrices.insert(matrices.end(), inverse.data(), inverse.data() + 16);
    joints.push_back(i);
  }
  return {{"name", "skeleton"},
          {"skeleton", 0},
          {"joints", joints},
          {"inverseBindMatrices", buffer.add(matrices, 16, kFloat)}};
}

std::vector<float> frame_times(const Clip& clip) {
  std::vector<float> times;
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    times.push_back(static_cast<float>(static_cast<double>(t) / clip.fps));
  return times;
}

std::vector<float> joint_rotations(const OutSkeleton& skeleton, const Clip& clip,
                                   std::size_t joint) {
  std::vector<float> rotations;
  Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    Eigen::Quaterniond now = out_rotation(skeleton, clip, t, joint);
    if (now.dot(before) < 0) now.coeffs() = -now.coeffs();
    for (int i = 0; i < 4; ++i) rotations.push_back(static_cast<float>(now.coeffs()[i]));
    before = now;
  }
  return rotations;
}

std::vector<float> places(const Clip& clip) {
  std::vector<float> numbers;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const Eigen::Vector3d place = out_place(clip, t);
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(place[axis]));
  }
  return numbers;
}

Json animation(const OutSkeleton& skeleton, const Clip& clip, const std::string& name,
               GlbBuffer& buffer) {
  Json samplers = Json::array(), channels = Json::array();
  const int times = buffer.add(frame_times(clip), 1, kFloat);
  const auto channel = [&](std::size_t node, const char* path, int output) {
    channels.push_back(
        {{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers.push_back({{"input", times}, {"output", output}, {"interpolation", "LINEAR"}});
  };
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i)
    if (skeleton.joints[i].travels) channel(i, "translation", buffer.add(places(clip), 3, kFloat));
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i)
    if (skeleton.joints[i].turns)
      channel(i, "rotation", buffer.add(joint_rotations(skeleton, clip, i), 4, kFloat));
  Json extras = {{"fps", clip.fps}};
  if (!clip.labels.empty()) extras["labels"] = clip.labels;
  return {{"name", name}, {"channels", channels}, {"samplers", samplers}, {"extras", extras}};
}

std::string checked_name(const Clip& clip, const char* extension) {
  const std::string name = clip.name.empty() ? "motion" : clip.name;
  if (clip.frames() > kMaxGlbFrames)
    throw DataError(in_file(name), "has " + std::to_string(clip.frames()) +
                                       " frames, more than the " + std::to_string(kMaxGlbFrames) +
                                       " of a " + extension + ": write a part");
  return name;
}

// The parts that a figure and an animation alone have in common; `scene` lists the nodes at the
// top.
Json document_of(const OutSkeleton& skeleton, const std::string& name, const Json& scene) {
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "mocaplm " MOCAPLM_VERSION}};
  document["scene"] = 0;
  document["scenes"] = Json::array({Json{{"name", name}, {"nodes", scene}}});
  document["nodes"] = joint_nodes(skeleton);
  return document;
}

std::string bytes_of(Json document, const Json& animation, const GlbBuffer& buffer) {
  document["animations"] = Json::array({animation});
  document["accessors"] = buffer.accessors();
  document["bufferViews"] = buffer.views();
  document["buffers"] = Json::array({Json{{"byteLength", buffer.bytes().size()}}});
  return glb_file(document, buffer.bytes());
}

}  // namespace

std::string glb_bytes(const Clip& clip, OutScheme scheme) {
  const std::string name = checked_name(clip, ".glb");
  const OutSkeleton skeleton = out_skeleton(clip, scheme);
  GlbBuffer buffer;
  const Json mesh = {{"name", "figure"},
                     {"primitives", Json::array({mesh_primitive(skeleton, clip, buffer)})}};
  const Json colour = {{"baseColorFactor", {0.079, 0.191, 0.823, 1.0}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 0.6}};
  const Json material = {{"name", "figure"}, {"pbrMetallicRoughness", colour}};

  const std::size_t figure = skeleton.joints.size();
  Json document = document_of(skeleton, name, {0, figure});
  document["nodes"].push_back({{"name", "figure"}, {"mesh", 0}, {"skin", 0}});
  document["meshes"] = Json::array({mesh});
  document["materials"] = Json::array({material});
  document["skins"] = Json::array({skin(skeleton, buffer)});
  return bytes_of(document, animation(skeleton, clip, name, buffer), buffer);
}

void write_glb(const std::filesystem::path& path, const Clip& clip, OutScheme scheme) {
  check_clip(clip, path.string());
  write_file(path, glb_bytes(clip, scheme));
}

std::string vrma_bytes(const Clip& clip) {
  const std::string name = checked_name(clip, ".vrma");
  const OutSkeleton skeleton = out_skeleton(clip, OutScheme::vrm, RestFeet::straight);
  GlbBuffer buffer;
  Json document = document_of(skeleton, name, Json::array({0}));
  Json bones = Json::object();
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i)
    bones[skeleton.joints[i].name] = {{"node", i}};
  document["extensionsUsed"] = Json::array({kVrmAnimation});
  document["extensions"][kVrmAnimation] = {{"specVersion", "1.0"},
                                           {"humanoid", {{"humanBones", bones}}}};
  return bytes_of(document, animation(skeleton, clip, name, buffer), buffer);
}

void write_vrma(const std::filesystem::path& path, const Clip& clip) {
  check_clip(clip, path.string());
  write_file(path, vrma_bytes(clip));
}

}  // namespace mocaplm
