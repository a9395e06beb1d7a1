// Trees of nodes that move, made at random and evaluated plainly, and the .gltf and ASCII .fbx
// files that hold them. Written from the formats' descriptions alone.
#pragma once

#include <Eigen/Geometry>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "common/json.h"
#include "common/random.h"

namespace mocaplm {

inline std::string base64(const std::string& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned value = 0;
    for (std::size_t k = 0; k < 3; ++k)
      value = value << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[value >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

// Translation, rotation, scale: applied from the last to the first.
struct Trs {
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  Eigen::Quaterniond r = Eigen::Quaterniond::Identity();
  Eigen::Vector3d s = Eigen::Vector3d::Ones();
  Eigen::Matrix4d matrix() const {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = r.toRotationMatrix() * s.asDiagonal();
    m.topRightCorner<3, 1>() = t;
    return m;
  }
};

struct MovingNode {
  std::string name;
  int parent = -1;
  Trs still;
  std::vector<Trs> frames;  // empty: does not move
};

// Parents first.
using MovingTree = std::vector<MovingNode>;

inline std::vector<Eigen::Matrix4d> places(const MovingTree& tree, int frame) {
  std::vector<Eigen::Matrix4d> world;
  for (const MovingNode& node : tree) {
    const Trs& own = frame < 0 || node.frames.empty()
                         ? node.still
                         : node.frames[static_cast<std::size_t>(frame)];
    world.push_back(node.parent < 0 ? own.matrix()
                                    : Eigen::Matrix4d(world[static_cast<std::size_t>(node.parent)] *
                                                      own.matrix()));
  }
  return world;
}

// A .gltf of one piece: its numbers as a data URI.
class GltfFile {
 public:
  explicit GltfFile(const MovingTree& tree) {
    json["asset"] = {{"version", "2.0"}};
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const Trs& own = tree[i].still;
      Json node = {{"name", tree[i].name},
                   {"translation", {own.t.x(), own.t.y(), own.t.z()}},
                   {"rotation", {own.r.x(), own.r.y(), own.r.z(), own.r.w()}},
                   {"scale", {own.s.x(), own.s.y(), own.s.z()}}};
      for (std::size_t child = i + 1; child < tree.size(); ++child)
        if (tree[child].parent == static_cast<int>(i)) node["children"].push_back(child);
      json["nodes"].push_back(node);
    }
    json["scenes"] = Json::array({Json{{"nodes", {0U}}}});
    json["scene"] = 0U;
  }

  // One animation with all frames of all nodes that move, at the times given.
  void animate(const MovingTree& tree, const std::vector<double>& times, const std::string& name,
               const std::string& interpolation = "LINEAR") {
    std::vector<float> seconds(times.begin(), times.end());
    const std::size_t input = add(seconds, 1);
    Json channels = Json::array(), samplers = Json::array();
    const auto channel = [&](std::size_t node, const char* path, std::size_t output) {
      channels.push_back(
          Json{{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
      samplers.push_back(
          Json{{"input", input}, {"output", output}, {"interpolation", interpolation}});
    };
    for (std::size_t i = 0; i < tree.size(); ++i) {
      if (tree[i].frames.empty()) continue;
      std::vector<float> t, r, s;
      for (const Trs& own : tree[i].frames) {
        for (int k = 0; k < 3; ++k) t.push_back(static_cast<float>(own.t[k]));
        for (int k = 0; k < 4; ++k) r.push_back(static_cast<float>(own.r.coeffs()[k]));
        for (int k = 0; k < 3; ++k) s.push_back(static_cast<float>(own.s[k]));
      }
      channel(i, "translation", add(t, 3));
      channel(i, "rotation", add(r, 4));
      channel(i, "scale", add(s, 3));
    }
    json["animations"].push_back(
        Json{{"name", name}, {"channels", channels}, {"samplers", samplers}});
  }

  // A triangle skinned to these nodes, bound where `places` says, hanging on a node of its own with
  // the place `mesh`; what is bound is seen from `seen` (the inverse bind matrices' own axes).
  void skin(const std::vector<int>& nodes, const std::vector<Eigen::Matrix4d>& places,
            const Eigen::Matrix4d& seen) {
    std::vector<float> matrices;
    Json joints = Json::array();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Eigen::Matrix4d inverse = (seen * places[i]).inverse();
      for (int k = 0; k < 16; ++k) matrices.push_back(static_cast<float>(inverse.data()[k]));
      joints.push_back(static_cast<std::size_t>(nodes[i]));
    }
    const std::size_t bind = add(matrices, 16);
    const std::size_t corners = add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    const std::size_t of = add<std::uint16_t>(std::vector<std::uint16_t>(12, 0), 4);
    const std::size_t weights = add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
    const std::size_t index = json.value("meshes", Json::array()).size();
    json["meshes"].push_back(
        Json{{"primitives",
              Json::array(
                  {Json{{"attributes",
                         {{"POSITION", corners}, {"JOINTS_0", of}, {"WEIGHTS_0", weights}}}}})}});
    json["skins"].push_back(Json{{"joints", joints}, {"inverseBindMatrices", bind}});
    json["scenes"][0]["nodes"].push_back(json["nodes"].size());
    json["nodes"].push_back(
        Json{{"name", "Body" + std::to_string(index)}, {"mesh", index}, {"skin", index}});
  }

  template <class Number>
  std::size_t add(const std::vector<Number>& numbers, std::size_t width) {
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    json["bufferViews"].push_back(Json{{"buffer", 0U},
                                       {"byteOffset", bytes_.size()},
                                       {"byteLength", numbers.size() * sizeof(Number)}});
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
    const char* type = width == 1 ? "SCALAR" : width == 3 ? "VEC3" : width == 4 ? "VEC4" : "MAT4";
    Json accessor = {{"bufferView", json["bufferViews"].size() - 1},
                     {"componentType", sizeof(Number) == 2 ? 5123U : 5126U},
                     {"count", numbers.size() / width},
                     {"type", type}};
    json["accessors"].push_back(accessor);
    return json["accessors"].size() - 1;
  }

  std::string text() const {
    Json all = json;
    if (!bytes_.empty())
      all["buffers"] =
          Json::array({Json{{"byteLength", bytes_.size()},
                            {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}});
    return all.dump();
  }
  const std::string& bytes() const { return bytes_; }

  Json json;

 private:
  std::string bytes_;
};

}  // namespace mocaplm
