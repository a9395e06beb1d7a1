#include "motion/formats/gltf_scene.h"

#include <cmath>

#include "common/error.h"
#include "common/files.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxNodes = 100000;

[[noreturn]] void fail(const std::string& file, const std::string& what) {
  throw DataError(in_file(file), what);
}

std::size_t u32(const std::string& bytes, std::size_t at, const std::string& file) {
  if (bytes.size() < 4 || at > bytes.size() - 4)
    throw DataError(at_byte(file, bytes.size()), "ends in the middle of a .glb");
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

struct Chunk {
  std::string type, bytes;
  std::size_t end = 0;
};

Chunk chunk_at(const std::string& bytes, std::size_t at, const std::string& file) {
  const std::size_t length = u32(bytes, at, file);
  u32(bytes, at + 4, file);
  if (length > bytes.size() - at - 8)
    throw DataError(at_byte(file, at), "announces " + std::to_string(length) +
                                           " bytes, and the file ends after " +
                                           std::to_string(bytes.size() - at - 8));
  return {bytes.substr(at + 4, 4), bytes.substr(at + 8, length), at + 8 + length};
}

// The numbers of a node's property, or none.
std::vector<double> numbers_of(const Json& node, const char* key, std::size_t count,
                               const std::string& file, std::size_t index) {
  std::vector<double> numbers;
  if (!node.contains(key)) return numbers;
  const Json& list = node[key];
  bool sound = list.is_array() && list.size() == count;
  for (std::size_t i = 0; sound && i < count; ++i) {
    sound = list[i].is_number() && std::isfinite(list[i].get<double>()) &&
            std::abs(list[i].get<double>()) < 1e6;
    if (sound) numbers.push_back(list[i].get<double>());
  }
  if (!sound)
    fail(file, "node " + std::to_string(index) + ": \"" + key + "\" is no list of " +
                   std::to_string(count) + " numbers below a million");
  return numbers;
}

GltfNode node_of(const Json& json, const std::string& file, std::size_t index) {
  if (!json.is_object()) fail(file, "node " + std::to_string(index) + " is no object");
  GltfNode node;
  if (json.contains("name") && json["name"].is_string()) node.name = json["name"];
  const auto move = numbers_of(json, "translation", 3, file, index),
             turn = numbers_of(json, "rotation", 4, file, index),
             scale = numbers_of(json, "scale", 3, file, index),
             matrix = numbers_of(json, "matrix", 16, file, index);
  if (!move.empty()) node.translation = {move[0], move[1], move[2]};
  if (!turn.empty()) node.rotation = Eigen::Quaterniond(turn[3], turn[0], turn[1], turn[2]);
  if (!scale.empty()) node.scale = {scale[0], scale[1], scale[2]};
  if (!matrix.empty()) {
    const Eigen::Map<const Eigen::Matrix4d> all(matrix.data());
    node.translation = all.topRightCorner<3, 1>();
    const Eigen::Matrix3d linear = all.topLeftCorner<3, 3>();
    node.scale = linear.colwise().norm().transpose();
    if (linear.determinant() < 0) node.scale.x() *= -1;
    if (node.scale.cwiseAbs().minCoeff() > 1e-9)
      node.rotation =
          Eigen::Quaterniond(Eigen::Matrix3d(linear * node.scale.cwiseInverse().asDiagonal()));
  }
  if (node.rotation.norm() < 1e-6)
    fail(file, "node " + std::to_string(index) + " has a rotation of length 0");
  node.rotation.normalize();
  return node;
}

// Fills in the parents, and the order; refuses what is no tree.
void link(GltfScene& scene, const Json& nodes) {
  const std::size_t count = nodes.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!nodes[i].contains("children")) continue;
    const Json& children = nodes[i]["children"];
    if (!children.is_array()) fail(scene.file, "the children of a node are no list");
    for (const Json& child : children) {
      if (!child.is_number_unsigned() || child.get<std::size_t>() >= count)
        fail(scene.file, "node " + std::to_string(i) + " has a child that is no node");
      int& parent = scene.nodes[child.get<std::size_t>()].parent;
      if (parent >= 0)
        fail(scene.file, "node " + std::to_string(child.get<std::size_t>()) + " has two parents");
      parent = static_cast<int>(i);
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    if (scene.nodes[i].parent < 0) scene.order.push_back(static_cast<int>(i));
  for (std::size_t next = 0; next < scene.order.size(); ++next) {
    const Json& node = nodes[static_cast<std::size_t>(scene.order[next])];
    if (!node.contains("children")) continue;
    for (const Json& child : node["children"]) scene.order.push_back(child.get<int>());
  }
  if (scene.order.size() != count) fail(scene.file, "has nodes that are their own ancestors");
}

// Every list that is added to must be one.
void check_lists(const GltfScene& scene) {
  for (const char* key : {"accessors", "animations", "bufferViews", "buffers", "nodes", "skins"})
    if (scene.document.contains(key) && !scene.document[key].is_array())
      fail(scene.file, std::string("\"") + key + "\" is no list");
}

}  // namespace

GltfScene read_gltf_scene(const std::filesystem::path& path) {
  return parse_gltf_scene(read_file(path), path.string());
}

GltfScene parse_gltf_scene(const std::string& bytes, const std::string& file) {
  GltfScene scene;
  scene.file = file;
  if (bytes.compare(0, 4, "glTF") != 0)
    throw DataError(at_byte(scene.file, 0), "is no .glb: it does not begin with \"glTF\"");
  if (u32(bytes, 4, scene.file) != 2)
    throw DataError(
        at_byte(scene.file, 4),
        "is a .glb of version " + std::to_string(u32(bytes, 4, scene.file)) + ", expected 2");
  const Chunk text = chunk_at(bytes, 12, scene.file);
  if (text.type != "JSON") throw DataError(at_byte(scene.file, 16), "expected the chunk \"JSON\"");
  scene.document = parse_json(text.bytes, scene.file);
  if (!scene.document.is_object()) fail(scene.file, "its JSON is no object");
  check_lists(scene);
  if (text.end < bytes.size()) {
    Chunk binary = chunk_at(bytes, text.end, scene.file);
    if (binary.type == std::string("BIN\0", 4)) scene.numbers = std::move(binary.bytes);
  }
  const Json buffers = scene.document.value("buffers", Json::array());
  if (!buffers.empty()) {
    const Json& first = buffers[0];
    if (!first.is_object() || first.contains("uri") || !first.contains("byteLength") ||
        !first["byteLength"].is_number_unsigned())
      fail(scene.file, "keeps its numbers in other files; expected a .glb that holds all of them");
    const auto length = first["byteLength"].get<std::size_t>();
    if (length > scene.numbers.size())
      fail(scene.file, "announces " + std::to_string(length) + " bytes of numbers and holds " +
                           std::to_string(scene.numbers.size()));
    scene.numbers.resize(length);
  }
  const Json nodes = scene.document.value("nodes", Json::array());
  if (nodes.empty() || nodes.size() > kMaxNodes)
    fail(scene.file, "has " + std::to_string(nodes.size()) + " nodes, expected 1 to " +
                         std::to_string(kMaxNodes));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    scene.nodes.push_back(node_of(nodes[i], scene.file, i));
  link(scene, nodes);
  return scene;
}

std::string with_animation(const GltfScene& scene, const Json& animation, const GlbBuffer& buffer) {
  Json document = scene.document;
  const auto list = [&](const char* key) -> Json& {
    if (!document.contains(key)) document[key] = Json::array();
    return document[key];
  };
  for (const Json& channel : animation["channels"]) {
    const auto index = channel["target"]["node"].get<std::size_t>();
    Json& json = document["nodes"][index];
    if (!json.contains("matrix")) continue;
    const GltfNode& node = scene.nodes[index];
    json.erase("matrix");
    json["translation"] = {node.translation.x(), node.translation.y(), node.translation.z()};
    json["rotation"] = {node.rotation.x(), node.rotation.y(), node.rotation.z(), node.rotation.w()};
    json["scale"] = {node.scale.x(), node.scale.y(), node.scale.z()};
  }
  std::string numbers = scene.numbers;
  numbers.resize((numbers.size() + 3) / 4 * 4, '\0');
  const std::size_t views = list("bufferViews").size(), start = numbers.size();
  for (Json view : buffer.views()) {
    view["byteOffset"] = view["byteOffset"].get<std::size_t>() + start;
    document["bufferViews"].push_back(view);
  }
  list("accessors");
  for (Json accessor : buffer.accessors()) {
    accessor["bufferView"] = accessor["bufferView"].get<std::size_t>() + views;
    document["accessors"].push_back(accessor);
  }
  numbers += buffer.bytes();
  if (list("buffers").empty()) document["buffers"].push_back(Json::object());
  document["buffers"][0]["byteLength"] = numbers.size();
  Json& animations = list("animations");
  animations.insert(animations.begin(), animation);
  return glb_file(document, numbers);
}

}  // namespace mocaplm
