#include "app/scene/files.h"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>
#include <cstring>

#include "common/files.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

bool is_name(const std::string& file, const std::string& name) {
  return fs::path(file).lexically_normal() == name;
}

// A copy that the stream owns.
Assimp::IOStream* stream_of(const std::string& bytes) {
  auto* copy = new std::uint8_t[bytes.size()];
  std::memcpy(copy, bytes.data(), bytes.size());
  return new Assimp::MemoryIOStream(copy, bytes.size(), true);
}

}  // namespace

fs::path SceneFiles::beside(const std::string& file) const {
  if (folder_.empty() || fs::path(file).is_absolute()) return {};
  std::error_code error;
  const fs::path folder = fs::canonical(folder_, error);
  const fs::path path = fs::canonical(folder / file, error);  // links are followed
  if (error || !fs::is_regular_file(path, error)) return {};
  const bool below =
      std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
  return below ? path : fs::path();
}

void SceneFiles::Close(Assimp::IOStream* stream) {
  delete stream;
}

bool SceneFiles::Exists(const char* file) const {
  if (is_name(file, name_) || !beside(file).empty()) return true;
  missing_ = file;
  return false;
}

Assimp::IOStream* SceneFiles::Open(const char* file, const char* mode) {
  if (std::strpbrk(mode, "wa+") != nullptr) return nullptr;
  if (is_name(file, name_))
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()),
                                      bytes_.size());
  const fs::path path = beside(file);
  if (!path.empty()) return stream_of(read_file(path));
  missing_ = file;
  return nullptr;
}

}  // namespace mocaplm
