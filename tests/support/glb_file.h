// A second reader of .glb files, written from the glTF 2.0 specification alone: plain loops, no
// Eigen, nothing of the program's but its JSON parser. Fails the test where a file is not as the
// specification says.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "common/json.h"

namespace mocaplm {

using Float3 = std::array<double, 3>;
using Float4 = std::array<double, 4>;  // quaternion x, y, z, w

class GlbFile {
 public:
  explicit GlbFile(const std::string& bytes) : bytes_(bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(u32(4), 2u);
    EXPECT_EQ(u32(8), bytes.size());
    const std::size_t text = u32(12);
    EXPECT_EQ(text % 4, 0u);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    json = Json::parse(bytes.substr(20, text));
    const std::size_t binary = 20 + text;
    EXPECT_EQ(u32(binary) % 4, 0u);
    EXPECT_EQ(bytes.substr(binary + 4, 4), std::string("BIN\0", 4));
    EXPECT_EQ(binary + 8 + u32(binary), bytes.size());
    start_ = binary + 8;
    const std::size_t length = json["buffers"][0]["byteLength"];
    EXPECT_LE(length, u32(binary));
    EXPECT_LT(u32(binary), length + 4);
    for (std::size_t i = 0; i < json["accessors"].size(); ++i) check_accessor(i, length);
  }

  // All numbers of an accessor, element after element.
  std::vector<double> numbers(std::size_t accessor) const {
    const Json& a = json["accessors"][accessor];
    const Json& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::size_t at = start_ + view["byteOffset"].get<std::size_t>() + offset(a);
    const std::size_t size = component_size(a);
    std::vector<double> out(a["count"].get<std::size_t>() * width(a));
    for (std::size_t i = 0; i < out.size(); ++i) {
      const char* from = bytes_.data() + at + i * size;
      if (size == 4) {
        float value;
        std::memcpy(&value, from, 4);
        out[i] = value;
      } else {
        std::uint16_t value = 0;
        std::memcpy(&value, from, size);
        out[i] = value;
      }
    }
    return out;
  }

  // The animation's values at one of its frames: translation and rotation of every node.
  struct Pose {
    std::vector<Float3> translations, positions;  // local, world
    std::vector<Float4> rotations, turns;         // local, world
  };
  Pose pose(std::size_t frame) const {
    const Json& nodes = json["nodes"];
    Pose pose;
    for (const Json& node : nodes) {
      EXPECT_FALSE(node.contains("matrix") || node.contains("scale"));
      pose.translations.push_back(node.value("translation", Float3{0, 0, 0}));
      pose.rotations.push_back(node.value("rotation", Float4{0, 0, 0, 1}));
    }
    const Json& animation = json["animations"][0];
    for (const Json& channel : animation["channels"]) {
      const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
      const std::vector<double> values = numbers(sampler["output"]);
      const std::size_t node = channel["target"]["node"];
      const bool turns = channel["target"]["path"] == "rotation";
      for (std::size_t i = 0; i < (turns ? 4u : 3u); ++i) {
        double& target = turns ? pose.rotations[node][i] : pose.translations[node][i];
        target = values[frame * (turns ? 4 : 3) + i];
      }
    }
    pose.positions.resize(nodes.size());
    pose.turns.resize(nodes.size());
    for (const Json& root : json["scenes"][json["scene"].get<std::size_t>()]["nodes"])
      place(root, {0, 0, 0}, {0, 0, 0, 1}, pose);
    return pose;
  }

  static Float3 rotate(const Float4& q, const Float3& v) {
    // v + 2 w (r x v) + 2 r x (r x v), r the vector part.
    const Float3 r = {q[0], q[1], q[2]};
    const Float3 a = cross(r, v), b = cross(r, a);
    return {v[0] + 2 * (q[3] * a[0] + b[0]), v[1] + 2 * (q[3] * a[1] + b[1]),
            v[2] + 2 * (q[3] * a[2] + b[2])};
  }

  // First `b`, then `a`.
  static Float4 product(const Float4& a, const Float4& b) {
    return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
            a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
            a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
            a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
  }

  Json json;

 private:
  static Float3 cross(const Float3& a, const Float3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  void place(std::size_t node, const Float3& origin, const Float4& turn, Pose& pose) const {
    const Float3 moved = rotate(turn, pose.translations[node]);
    for (std::size_t i = 0; i < 3; ++i) pose.positions[node][i] = origin[i] + moved[i];
    pose.turns[node] = product(turn, pose.rotations[node]);
    for (const Json& child : json["nodes"][node].value("children", Json::array()))
      place(child, pose.positions[node], pose.turns[node], pose);
  }

  std::size_t u32(std::size_t at) const {
    std::size_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= static_cast<std::size_t>(static_cast<unsigned char>(bytes_.at(at + i))) << (8 * i);
    return value;
  }

  static std::size_t offset(const Json& accessor) {
    return accessor.value("byteOffset", std::size_t{0});
  }
  static std::size_t component_size(const Json& accessor) {
    const int type = accessor["componentType"];
    EXPECT_TRUE(type == 5121 || type == 5123 || type == 5126) << type;
    return type == 5121 ? 1 : type == 5123 ? 2 : 4;
  }
  static std::size_t width(const Json& accessor) {
    const std::string type = accessor["type"];
    EXPECT_TRUE(type == "SCALAR" || type == "VEC3" || type == "VEC4" || type == "MAT4") << type;
    return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
  }

  // Inside its view and the buffer, aligned, and with the bounds that its numbers have.
  void check_accessor(std::size_t index, std::size_t buffer_length) const {
    SCOPED_TRACE(index);
    const Json& accessor = json["accessors"][index];
    const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t from = view.value("byteOffset", std::size_t{0});
    const std::size_t length = view["byteLength"];
    const std::size_t count = accessor["count"], size = component_size(accessor);
    EXPECT_GE(count, 1u);
    EXPECT_LE(from + length, buffer_length);
    EXPECT_LE(offset(accessor) + count * width(accessor) * size, length);
    EXPECT_EQ((from + offset(accessor)) % 4, 0u);
    if (size != 4) return;
    const std::vector<double> all = numbers(index);
    for (std::size_t c = 0; c < width(accessor); ++c) {
      double low = all[c], high = all[c];
      for (std::size_t i = c; i < all.size(); i += width(accessor)) {
        low = std::fmin(low, all[i]);
        high = std::fmax(high, all[i]);
      }
      EXPECT_EQ(accessor["min"][c].get<double>(), low);
      EXPECT_EQ(accessor["max"][c].get<double>(), high);
    }
  }

  std::string bytes_;
  std::size_t start_ = 0;  // of the binary chunk's bytes
};

}  // namespace mocaplm
