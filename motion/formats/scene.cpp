#include "motion/formats/scene.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <unordered_set>

#include "common/error.h"

namespace mocaplm {

namespace {

constexpr std::string_view kSceneMagic = "mocaplm scene 1\n";
constexpr double kLargestNumber = 1e9;
constexpr std::size_t kMaxNodeName = 1024;

template <class Number>
void append(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number,
              sizeof number);  // all machines that this is built for are little-endian
  bytes.append(raw, sizeof number);
}

void append_count(std::string& bytes, std::size_t count) {
  append(bytes, static_cast<std::uint32_t>(count));
}

void append_text(std::string& bytes, const std::string& text) {
  append_count(bytes, text.size());
  bytes += text;
}

template <class Matrix>
void append_matrix(std::string& bytes, const Matrix& matrix) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      append(bytes, static_cast<double>(matrix(row, column)));
}

void append_keys(std::string& bytes, const SceneKeys<Eigen::Vector3f>& keys) {
  append_count(bytes, keys.times.size());
  for (std::size_t i = 0; i < keys.times.size(); ++i) {
    append(bytes, keys.times[i]);
    for (int axis = 0; axis < 3; ++axis) append(bytes, keys.values[i][axis]);
  }
}

void append_keys(std::string& bytes, const SceneKeys<Eigen::Quaternionf>& keys) {
  append_count(bytes, keys.times.size());
  for (std::size_t i = 0; i < keys.times.size(); ++i) {
    append(bytes, keys.times[i]);
    const Eigen::Quaternionf& q = keys.values[i];
    for (const float part : {q.w(), q.x(), q.y(), q.z()}) append(bytes, part);
  }
}

class Parser {
 public:
  Parser(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  Scene parse() {
    if (bytes_.substr(0, kSceneMagic.size()) != kSceneMagic)
      fail("the reader and this program are of different versions; install them together");
    at_ = kSceneMagic.size();
    Scene scene;
    scene.unit = number<double>();
    if (!(scene.unit >= 1e-6 && scene.unit <= 1e6)) fail("a unit of length that cannot be");
    matrix(scene.axes);
    scene.curves = number<std::uint8_t>() != 0;
    scene.meshes = number<std::uint32_t>();
    nodes(scene);
    for (std::size_t i = count(8); i > 0; --i) scene.skins.push_back(skin());
    for (std::size_t i = count(24); i > 0; --i) scene.takes.push_back(take());
    for (std::size_t i = count(8); i > 0; --i) {
      const std::string kind = text();
      scene.remarks.push_back({kind, text()});
    }
    if (at_ != bytes_.size()) fail("more bytes than expected");
    return scene;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw DataError(in_file(file_), "its reader's answer cannot be used: " + what);
  }

  template <class Number>
  Number number() {
    Number value;
    if (bytes_.size() - at_ < sizeof value) fail("it is cut off");
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    if (!(std::abs(static_cast<double>(value)) <=
          (std::is_floating_point<Number>::value ? kLargestNumber : 4294967295.0)))
      fail("a number that is not finite or beyond 1e9");
    return value;
  }
  // A count of things of at least so many bytes each: never more than there can be.
  std::size_t count(std::size_t least) {
    const std::size_t count = number<std::uint32_t>();
    if (count > (bytes_.size() - at_) / least) fail("it is cut off");
    return count;
  }
  std::string text() {
    const std::size_t size = count(1);
    const std::string text(bytes_.substr(at_, size));
    at_ += size;
    return text;
  }
  template <class Matrix>
  void matrix(Matrix& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row)
      for (Eigen::Index column = 0; column < matrix.cols(); ++column)
        matrix(row, column) = number<double>();
  }
  int node() {
    const auto index = number<std::uint32_t>();
    if (index >= nodes_) fail("a node that is not there");
    return static_cast<int>(index);
  }

  void nodes(Scene& scene) {
    std::unordered_set<std::string> names;
    nodes_ = count(137);
    if (nodes_ == 0) fail("no nodes");
    scene.nodes.resize(nodes_);
    for (std::size_t i = 0; i < nodes_; ++i) {
      SceneNode& node = scene.nodes[i];
      node.name = text();
      if (node.name.size() > kMaxNodeName || !names.insert(node.name).second)
        fail("a node's name that is too long or there twice");
      node.parent = number<std::int32_t>();
      if (i == 0 ? node.parent != -1 : node.parent < 0 || node.parent >= static_cast<int>(i))
        fail("a node before its parent");
      const auto kind = number<std::uint8_t>();
      if (kind > static_cast<int>(SceneNodeKind::helper)) fail("an unknown kind of node");
      node.kind = static_cast<SceneNodeKind>(kind);
      matrix(node.local);
    }
  }

  SceneSkin skin() {
    SceneSkin skin;
    skin.mesh_node = node();
    skin.bones.resize(count(132));
    for (SceneBone& bone : skin.bones) {
      bone.node = node();
      matrix(bone.from_mesh);
    }
    return skin;
  }

  double time(const std::vector<double>& before) {
    const double seconds = number<double>();
    if (!before.empty() && seconds < before.back()) fail("keys that go back in time");
    return seconds;
  }
  void keys(SceneKeys<Eigen::Vector3f>& keys) {
    const std::size_t n = count(20);
    if (n == 0) fail("a track without keys");
    for (std::size_t i = 0; i < n; ++i) {
      keys.times.push_back(time(keys.times));
      const float x = number<float>(), y = number<float>(), z = number<float>();
      keys.values.emplace_back(x, y, z);
    }
  }
  void keys(SceneKeys<Eigen::Quaternionf>& keys) {
    const std::size_t n = count(24);
    if (n == 0) fail("a track without keys");
    for (std::size_t i = 0; i < n; ++i) {
      keys.times.push_back(time(keys.times));
      const float w = number<float>(), x = number<float>(), y = number<float>(),
                  z = number<float>();
      keys.values.emplace_back(w, x, y, z);
    }
  }
  SceneTake take() {
    SceneTake take;
    take.name = text();
    take.begin = number<double>();
    take.end = number<double>();
    if (take.end < take.begin) fail("a take that ends before it begins");
    take.tracks.resize(count(16));
    for (SceneTrack& track : take.tracks) {
      track.node = node();
      keys(track.positions);
      keys(track.rotations);
      keys(track.scales);
    }
    return take;
  }

  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_ = 0, nodes_ = 0;
};

}  // namespace

Scene parse_scene(std::string_view bytes, const std::string& file) {
  return Parser(bytes, file).parse();
}

std::string scene_bytes(const Scene& scene) {
  std::string bytes(kSceneMagic);
  append(bytes, scene.unit);
  append_matrix(bytes, scene.axes);
  append(bytes, static_cast<std::uint8_t>(scene.curves));
  append_count(bytes, scene.meshes);
  append_count(bytes, scene.nodes.size());
  for (const SceneNode& node : scene.nodes) {
    append_text(bytes, node.name);
    append(bytes, static_cast<std::int32_t>(node.parent));
    append(bytes, static_cast<std::uint8_t>(node.kind));
    append_matrix(bytes, node.local);
  }
  append_count(bytes, scene.skins.size());
  for (const SceneSkin& skin : scene.skins) {
    append_count(bytes, static_cast<std::size_t>(skin.mesh_node));
    append_count(bytes, skin.bones.size());
    for (const SceneBone& bone : skin.bones) {
      append_count(bytes, static_cast<std::size_t>(bone.node));
      append_matrix(bytes, bone.from_mesh);
    }
  }
  append_count(bytes, scene.takes.size());
  for (const SceneTake& take : scene.takes) {
    append_text(bytes, take.name);
    append(bytes, take.begin);
    append(bytes, take.end);
    append_count(bytes, take.tracks.size());
    for (const SceneTrack& track : take.tracks) {
      append_count(bytes, static_cast<std::size_t>(track.node));
      append_keys(bytes, track.positions);
      append_keys(bytes, track.rotations);
      append_keys(bytes, track.scales);
    }
  }
  append_count(bytes, scene.remarks.size());
  for (const Remark& remark : scene.remarks) {
    append_text(bytes, remark.kind);
    append_text(bytes, remark.text);
  }
  return bytes;
}

}  // namespace mocaplm
