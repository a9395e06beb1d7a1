// A picture in memory, and as a PNG file (W3C, "Portable Network Graphics Specification", 2003).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mocaplm {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // (height, width, 3), sRGB, the upper row first

  Picture() = default;
  Picture(int w, int h)
      : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  std::uint8_t* at(int x, int y) { return rgb.data() + index(x, y); }
  const std::uint8_t* at(int x, int y) const { return rgb.data() + index(x, y); }

 private:
  std::size_t index(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x));
  }
};

// The bytes of an 8-bit RGB .png.
std::string png_bytes(const Picture& picture);

}  // namespace mocaplm
