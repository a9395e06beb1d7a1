#include "motion/formats/array_dict.h"

#include "common/files.h"
#include "common/text.h"
#include "motion/formats/array_dict_node.h"
#include "motion/formats/npy.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr std::uintmax_t kMaxFile = std::uintmax_t{512} << 20;

// Files that are named as if they held arrays, and do not in a way that is read.
std::string other_format(std::string_view head) {
  if (starts_with(head, "\x89HDF")) return "an HDF5 file (.h5)";
  if (starts_with(head, "BZh")) return "compressed by bzip2";
  if (starts_with(head, std::string_view("\xfd\x37zXZ", 5))) return "compressed by xz";
  if (starts_with(head, "\x5d\x00\x00\x80")) return "compressed by lzma";
  if (starts_with(head, "\x04\x22\x4d\x18")) return "compressed by lz4";
  if (starts_with(head, "\x28\xb5\x2f\xfd")) return "compressed by zstd";
  if (starts_with(head, "{") || starts_with(head, "[")) return "a JSON text";
  if (starts_with(head, "MATLAB")) return "a MATLAB file (.mat)";
  if (starts_with(head, "version https://git-lfs"))
    return "a Git LFS pointer, not the file itself: fetch it with 'git lfs pull'";
  if (starts_with(head, "(") || starts_with(head, "c") || starts_with(head, "}"))
    return "a pickle of protocol 0 or 1 (Python 2)";
  return "";
}

ArrayDict from_bytes(std::string bytes, const std::string& file) {
  if (starts_with(bytes, "\x93NUMPY")) {
    const std::string_view pickle = pickle_of_npy(bytes);
    if (pickle.empty()) {
      const NumpyArray array = parse_npy(bytes, file);
      const std::size_t last = array.shape.empty() ? 0 : array.shape.back();
      throw DataError(
          in_file(file),
          "is one array " + shape_text(array) + " without names" +
              (last == 263 || last == 251
                   ? ", HumanML3D's features: keep the joint positions that they come from"
                   : "") +
              "; expected a dictionary of arrays");
    }
    return pickled_dict(std::string(pickle), file);
  }
  if (!bytes.empty() && bytes[0] != '\x80') {
    if (const std::string other = other_format(bytes); !other.empty())
      throw DataError(at_byte(file, 0),
                      "is " + other +
                          "; expected a pickle of protocol 2 or newer, a .npz or a "
                          ".npy: load it in Python and save its arrays with "
                          "numpy.savez");
  }
  return pickled_dict(std::move(bytes), file);
}

}  // namespace

ArrayDict ArrayDict::open(const fs::path& path) {
  const std::string file = path.string(), head = read_head(path, 8);
  if (head.empty()) throw DataError(in_file(file), "is empty");
  if (starts_with(head, "PK\3\4") || starts_with(head, "PK\5\6")) return archived_dict(path);
  std::string bytes = read_file(path, kMaxFile);
  const bool zlib =
      head.size() >= 2 && head[0] == '\x78' &&
      ((static_cast<unsigned char>(head[0]) << 8 | static_cast<unsigned char>(head[1])) % 31 == 0);
  if (zlib || starts_with(head, "\x1f\x8b")) bytes = inflate(bytes, file);
  return from_bytes(std::move(bytes), file);
}

bool is_dict_npy(const fs::path& path) {
  const std::string head = read_head(path, 128);
  return starts_with(head, "\x93NUMPY") &&
         (head.find("'|O'") != std::string::npos || head.find("'O'") != std::string::npos);
}

std::vector<std::string> ArrayDict::keys() const {
  return node_->keys();
}

bool ArrayDict::has(const std::string& key) const {
  return node_->has(key);
}

NumpyArray ArrayDict::array(const std::string& key) const {
  return node_->array(key);
}

std::optional<ArrayDict> ArrayDict::dict(const std::string& key) const {
  return node_->dict(key);
}

std::optional<std::string> ArrayDict::text(const std::string& key) const {
  return node_->text(key);
}

Place ArrayDict::place(const std::string& key) const {
  return node_->place(key);
}

const std::string& ArrayDict::file() const {
  return node_->file;
}

std::string ArrayDict::contents() const {
  std::vector<std::string> names = keys();
  const std::size_t all = names.size();
  if (all > 20) names.resize(20);
  for (std::string& name : names) {
    name = name.substr(0, 40);
    for (char& c : name)  // a message must not carry control sequences
      if (c >= 0 && c < ' ') c = '?';
  }
  return names.empty() ? "nothing" : join(names, ", ") + (all > 20 ? ", ..." : "");
}

}  // namespace mocaplm
