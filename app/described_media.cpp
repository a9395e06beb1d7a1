// What convert and render write, from the files' own headers.
#include <algorithm>

#include "app/described_parts.h"
#include "common/error.h"
#include "common/files.h"
#include "common/json.h"
#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// The file from `at` on begins with `magic`.
bool begins(const std::string& bytes, const std::string& magic, std::size_t at = 0) {
  return bytes.size() >= at + magic.size() && bytes.compare(at, magic.size(), magic) == 0;
}

// An unsigned number of `count` bytes, the last one the lowest.
std::uint64_t big_endian(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::uint64_t little_endian(const std::string& bytes, std::size_t at, std::size_t count) {
  std::string turned = bytes.substr(at, count);
  std::reverse(turned.begin(), turned.end());
  return big_endian(turned, 0, count);
}

// The JSON chunk: its length, "JSON", its text, after a head of 12 bytes.
Json gltf_json(const fs::path& file) {
  const std::string name = file.string(), head = read_head(file, 20);
  if (!begins(head, "glTF") || head.size() < 20 || !begins(head, "JSON", 16))
    throw DataError(in_file(name), "does not begin as a binary glTF file does (glTF, then JSON)");
  const std::uint64_t length = little_endian(head, 12, 4), left = fs::file_size(file) - 20;
  if (length > left)
    throw DataError(at_byte(name, 12), "tells of " + std::to_string(length) +
                                           " bytes of JSON; the file ends after " +
                                           std::to_string(left));
  return parse_json(read_head(file, 20 + length).substr(20), name);
}

// The last time of an animation: the greatest "max" of the accessors that its samplers read.
double seconds_of(const Json& gltf, const Json& animation) {
  double seconds = 0;
  for (const Json& sampler : animation.value("samplers", Json::array())) {
    const Json& accessor = gltf.at("accessors").at(sampler.at("input").get<std::size_t>());
    seconds = std::max(seconds, accessor.at("max").at(0).get<double>());
  }
  return seconds;
}

void add_size(Table& table, const fs::path& file) {
  table.row({"size", format_fixed(static_cast<double>(fs::file_size(file)) / 1e6, 2) + " MB"});
}

}  // namespace

std::vector<Table> describe_glb(const fs::path& file) {
  const Json gltf = gltf_json(file);
  try {
    Table table(file.string(), {"glTF (binary)", "value"});
    table.row({"made by", gltf.at("asset").value("generator", "unknown")});
    table.row({"nodes", gltf.value("nodes", Json::array()).size()});
    table.row({"skins", gltf.value("skins", Json::array()).size()});
    for (const Json& animation : gltf.value("animations", Json::array()))
      table.row({"animation " + animation.value("name", "without a name"),
                 format_fixed(seconds_of(gltf, animation), 2) + " s"});
    add_size(table, file);
    table.note("For Blender and 3D viewers; mocaplm writes it and reads it back.");
    return {table};
  } catch (const Json::exception& error) {
    throw DataError(in_file(file.string()), std::string("is no sound glTF: ") + error.what());
  }
}

std::vector<Table> describe_film(const fs::path& file) {
  const std::string bytes = read_head(file, 64);  // a film may be larger than the memory
  const bool png = begins(bytes, "\x89PNG\r\n\x1a\n") && bytes.size() >= 24,
             gif = begins(bytes, "GIF8") && bytes.size() >= 10, mp4 = begins(bytes, "ftyp", 4);
  if (!png && !gif && !mp4)
    throw DataError(in_file(file.string()), "does not begin as a PNG, GIF or MP4 file does");
  Table table(file.string(), {png ? "picture (PNG)" : gif ? "film (GIF)" : "film (MP4)", "value"});
  if (png)
    table.row({"pixels", std::to_string(big_endian(bytes, 16, 4)) + " x " +
                             std::to_string(big_endian(bytes, 20, 4))});
  if (gif)
    table.row({"pixels", std::to_string(little_endian(bytes, 6, 2)) + " x " +
                             std::to_string(little_endian(bytes, 8, 2))});
  add_size(table, file);
  return {table};
}

}  // namespace mocaplm
