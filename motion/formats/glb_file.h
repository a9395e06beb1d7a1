// The parts of a .glb file that is written (motion/formats/glb.h says how it is laid out).
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <string>
#include <vector>

#include "common/json.h"

namespace mocaplm {

// So many frames have times that differ as 4-byte floats at any rate, and fit into 4 GiB.
constexpr std::int64_t kMaxGlbFrames = std::int64_t{1} << 23;

// glTF's numbers for the type of a component, and for what a piece of the buffer is for.
enum GlbComponent { kUint8 = 5121, kUint16 = 5123, kFloat = 5126 };
enum GlbTarget { kNoTarget = 0, kVertices = 34962, kIndices = 34963 };

// The binary chunk, and the list of what lies where in it.
class GlbBuffer {
 public:
  // A piece of so many elements of `width` components each; returns its accessor's index.
  template <class Number>
  int add(const std::vector<Number>& numbers, int width, GlbComponent component,
          GlbTarget target = kNoTarget) {
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

// The file: header and two chunks. The document's buffers must say how long `numbers` is.
std::string glb_file(const Json& document, const std::string& numbers);

}  // namespace mocaplm
