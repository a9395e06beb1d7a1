#include "viewer/pack.h"

#include <zlib.h>

#include "common/error.h"
#include "viewer/html.h"

namespace mocaplm {

namespace {

// Unsigned arithmetic wraps where the guess leaves 16 bits, and the way back wraps the same.
std::uint16_t folded_difference(const std::vector<std::int16_t>& values, std::size_t at,
                                std::size_t frame, std::size_t channels) {
  const auto value = [&](std::size_t back) {
    return static_cast<std::uint32_t>(values[at - back * channels]);
  };
  std::uint32_t difference = value(0);
  if (frame > 0) difference -= value(1);
  if (frame > 1) difference -= value(1) - value(2);
  difference &= 0xFFFF;
  return static_cast<std::uint16_t>(difference << 1 ^ (difference & 0x8000 ? 0xFFFF : 0));
}

}  // namespace

std::string pack_points(const std::vector<std::int16_t>& values, std::int64_t channels) {
  const auto width = static_cast<std::size_t>(channels);
  const std::size_t frames = values.size() / width, count = frames * width;
  std::vector<std::uint8_t> bytes(2 * count);
  std::size_t out = 0;
  for (std::size_t c = 0; c < width; ++c)
    for (std::size_t f = 0; f < frames; ++f, ++out) {
      const std::uint16_t folded = folded_difference(values, f * width + c, f, width);
      bytes[out] = static_cast<std::uint8_t>(folded & 0xFF);
      bytes[count + out] = static_cast<std::uint8_t>(folded >> 8);
    }
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), bytes.size(), Z_BEST_COMPRESSION) != Z_OK)
    throw Error(ExitCode::internal, "zlib could not pack the motion of a page: no memory");
  packed.resize(size);
  return base64(packed);
}

}  // namespace mocaplm
