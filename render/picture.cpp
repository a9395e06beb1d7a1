#include "render/picture.h"

#include <zlib.h>

#include "common/error.h"

namespace mocaplm {

namespace {

void append_u32(std::string& bytes, std::uint32_t value) {  // big-endian
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
}

void append_chunk(std::string& bytes, const std::string& type, const std::string& data) {
  append_u32(bytes, static_cast<std::uint32_t>(data.size()));
  const std::string body = type + data;
  bytes += body;
  append_u32(bytes,
             static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                                static_cast<uInt>(body.size()))));
}

// Each row as its difference from the one above (filter 2), which compresses well.
std::string filtered_rows(const Picture& picture) {
  const std::size_t stride = 3 * static_cast<std::size_t>(picture.width);
  std::string rows;
  rows.reserve((stride + 1) * static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.at(0, y);
    const std::uint8_t* above = y > 0 ? picture.at(0, y - 1) : nullptr;
    rows += '\2';
    for (std::size_t i = 0; i < stride; ++i)
      rows += static_cast<char>(row[i] - (above ? above[i] : 0));
  }
  return rows;
}

}  // namespace

std::string png_bytes(const Picture& picture) {
  const std::string rows = filtered_rows(picture);
  uLongf size = ::compressBound(rows.size());
  std::string packed(size, '\0');
  if (::compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                  reinterpret_cast<const Bytef*>(rows.data()), rows.size(), 6) != Z_OK)
    throw Error(ExitCode::internal, "zlib could not compress a picture");
  packed.resize(size);
  std::string header;
  append_u32(header, static_cast<std::uint32_t>(picture.width));
  append_u32(header, static_cast<std::uint32_t>(picture.height));
  header += std::string("\10\2\0\0\0", 5);  // 8 bits, RGB, deflate, filters, not interlaced
  std::string bytes = "\x89PNG\r\n\x1a\n";
  append_chunk(bytes, "IHDR", header);
  append_chunk(bytes, "IDAT", packed);
  append_chunk(bytes, "IEND", "");
  return bytes;
}

}  // namespace mocaplm
