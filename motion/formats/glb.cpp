#include "motion/formats/glb.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <vector>

#include "common/error.h"
#include "common/files.h"
#include "common/json.h"
#include "motion/body_mesh.h"
#include "motion/floor.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

// glTF's numbers for the type of a component, and for what a piece of the buffer is for.
enum Component { kUint8 = 5121, kUint16 = 5123, kFloat = 5126 };
enum Target { kNoTarget = 0, kVertices = 34962, kIndices = 34963 };
constexpr int kFigureNode = kJoints;
// So many frames have times that differ as 4-byte floats at any rate, and fit into 4 GiB.
constexpr Eigen::Index kMaxFrames = Eigen::Index{1} << 23;

void append_u32(std::string& bytes, std::size_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

// The binary chunk, and the list of what lies where in it.
class Buffer {
 public:
  // A piece of so many elements of `width` components each; returns its accessor's index.
  template <class Number>
  int add(const std::vector<Number>& numbers, int width, Component component,
          Target target = kNoTarget) {
    assert(numbers.size() % static_cast<std::size_t>(width) == 0);
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    Json view = {{"buffer", 0},
                 {"byteOffset", bytes_.size()},
                 {"byteLength", numbers.size() * sizeof(Number)}};
    if (target != kNoTarget) view["target"] = target;
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
    Json accessor = {{"bufferView", views_.size()},
                     {"componentType", component},
                     {"count", numbers.size() / static_cast<std::size_t>(width)},
                     {"type", type(width)}};
    if (component == kFloat) add_bounds(numbers, width, accessor);
    views_.push_back(view);
    accessors_.push_back(accessor);
    return static_cast<int>(accessors_.size()) - 1;
  }

  const Json& views() const { return views_; }
  const Json& accessors() const { return accessors_; }
  const std::string& bytes() const { return bytes_; }

 private:
  static const char* type(int width) {
    return width == 1 ? "SCALAR" : width == 3 ? "VEC3" : width == 4 ? "VEC4" : "MAT4";
  }

  // The smallest and largest value of each component.
  template <class Number>
  static void add_bounds(const std::vector<Number>& numbers, int width, Json& accessor) {
    const auto components = static_cast<std::size_t>(width);
    std::vector<Number> low(numbers.begin(), numbers.begin() + width), high = low;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      low[i % components] = std::min(low[i % components], numbers[i]);
      high[i % components] = std::max(high[i % components], numbers[i]);
    }
    accessor["min"] = low;
    accessor["max"] = high;
  }

  std::string bytes_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

std::vector<float> floats(const MeshPoints& points) {
  return {points.data(), points.data() + points.size()};
}

// How far the rest pose is lifted so that its soles stand at height 0.
double lift() {
  return kSoleBelowFoot - std::min(rest_joints()(10, 1), rest_joints()(11, 1));
}

Json joint_nodes() {
  Json nodes = Json::array();
  for (int j = 0; j < kJoints; ++j) {
    const int parent = joint_parents()[static_cast<std::size_t>(j)];
    Eigen::RowVector3d bone = rest_joints().row(j);
    if (parent < 0)
      bone.y() += lift();
    else
      bone -= rest_joints().row(parent);
    Json node = {{"name", joint_names()[static_cast<std::size_t>(j)]},
                 {"translation", {bone.x(), bone.y(), bone.z()}}};
    Json children = Json::array();
    for (int child = j + 1; child < kJoints; ++child)
      if (joint_parents()[static_cast<std::size_t>(child)] == j) children.push_back(child);
    if (!children.empty()) node["children"] = children;
    nodes.push_back(node);
  }
  return nodes;
}

Json mesh_primitive(Buffer& buffer) {
  const BodyMesh& mesh = body_mesh();
  MeshPoints positions = mesh.positions;
  positions.col(1).array() += static_cast<float>(lift());
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (const BodyMesh::Carried& carried : mesh.carried) {
    joints.insert(joints.end(), {carried.joints[0], carried.joints[1], 0, 0});
    weights.insert(weights.end(), {carried.weights[0], carried.weights[1], 0, 0});
  }
  return {{"attributes",
           {{"POSITION", buffer.add(floats(positions), 3, kFloat, kVertices)},
            {"NORMAL", buffer.add(floats(mesh.normals), 3, kFloat, kVertices)},
            {"JOINTS_0", buffer.add(joints, 4, kUint8, kVertices)},
            {"WEIGHTS_0", buffer.add(weights, 4, kFloat, kVertices)}}},
          {"indices", buffer.add(mesh.triangles, 1, kUint16, kIndices)},
          {"material", 0}};
}

// The bind pose has no rotations: each matrix, column after column, only takes the joint to the
// origin.
Json skin(Buffer& buffer) {
  std::vector<float> matrices;
  Json joints = Json::array();
  for (int j = 0; j < kJoints; ++j) {
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.topRightCorner<3, 1>() = -rest_joints().row(j).transpose().cast<float>();
    inverse(1, 3) -= static_cast<float>(lift());
    matrices.insert(matrices.end(), inverse.data(), inverse.data() + 16);
    joints.push_back(j);
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

std::vector<float> joint_rotations(const Clip& clip, int joint) {
  std::vector<float> rotations;
  Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const Eigen::Vector3d v = clip.poses.row(t).segment<3>(3 * joint).transpose();
    Eigen::Quaterniond now = quaternion_from_axis_angle(v);
    if (now.dot(before) < 0) now.coeffs() = -now.coeffs();
    for (int i = 0; i < 4; ++i) rotations.push_back(static_cast<float>(now.coeffs()[i]));
    before = now;
  }
  return rotations;
}

Json animation(const Clip& clip, const std::string& name, Buffer& buffer) {
  Json samplers = Json::array(), channels = Json::array();
  const int times = buffer.add(frame_times(clip), 1, kFloat);
  const auto channel = [&](int node, const char* path, int output) {
    channels.push_back(
        {{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers.push_back({{"input", times}, {"output", output}, {"interpolation", "LINEAR"}});
  };
  std::vector<float> pelvis;
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    for (int axis = 0; axis < 3; ++axis)
      pelvis.push_back(static_cast<float>(clip.trans(t, axis) + rest_joints()(0, axis)));
  channel(0, "translation", buffer.add(pelvis, 3, kFloat));
  for (int j = 0; j < kJoints; ++j)
    channel(j, "rotation", buffer.add(joint_rotations(clip, j), 4, kFloat));
  Json extras = {{"fps", clip.fps}};
  if (!clip.labels.empty()) extras["labels"] = clip.labels;
  return {{"name", name}, {"channels", channels}, {"samplers", samplers}, {"extras", extras}};
}

// The file: header and two chunks.
std::string glb_of(const Json& document, const std::string& numbers) {
  // A name may be any bytes; JSON is UTF-8.
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t padded = (numbers.size() + 3) / 4 * 4;
  const std::size_t total = 12 + 8 + text.size() + 8 + padded;
  std::string bytes = "glTF";
  append_u32(bytes, 2);
  append_u32(bytes, total);
  append_u32(bytes, text.size());
  bytes += "JSON" + text;
  append_u32(bytes, padded);
  bytes.append("BIN\0", 4).append(numbers);
  bytes.resize(total, '\0');
  return bytes;
}

}  // namespace

std::string glb_bytes(const Clip& clip) {
  const std::string name = clip.name.empty() ? "motion" : clip.name;
  if (clip.frames() > kMaxFrames)
    throw DataError(in_file(name), "has " + std::to_string(clip.frames()) +
                                       " frames, more than the " + std::to_string(kMaxFrames) +
                                       " of a .glb: write a part");
  Buffer buffer;
  Json nodes = joint_nodes();
  nodes.push_back({{"name", "figure"}, {"mesh", 0}, {"skin", 0}});
  const Json scene = {{"name", name}, {"nodes", {0, kFigureNode}}};
  const Json mesh = {{"name", "figure"}, {"primitives", Json::array({mesh_primitive(buffer)})}};
  const Json colour = {{"baseColorFactor", {0.079, 0.191, 0.823, 1.0}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 0.6}};
  const Json material = {{"name", "figure"}, {"pbrMetallicRoughness", colour}};

  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "mocaplm " MOCAPLM_VERSION}};
  document["scene"] = 0;
  document["scenes"] = Json::array({scene});
  document["nodes"] = nodes;
  document["meshes"] = Json::array({mesh});
  document["materials"] = Json::array({material});
  document["skins"] = Json::array({skin(buffer)});
  document["animations"] = Json::array({animation(clip, name, buffer)});
  document["accessors"] = buffer.accessors();
  document["bufferViews"] = buffer.views();
  document["buffers"] = Json::array({Json{{"byteLength", buffer.bytes().size()}}});
  return glb_of(document, buffer.bytes());
}

void write_glb(const std::filesystem::path& path, const Clip& clip) {
  check_clip(clip, path.string());
  write_file(path, glb_bytes(clip));
}

}  // namespace mocaplm
