// A file seen as memory: an index of gigabytes is opened at once and read only where it is needed.
#pragma once

#include <cstddef>
#include <filesystem>

namespace mocaplm {

class MappedFile {
 public:
  // Throws DataError when it is missing, empty, no regular file or cannot be mapped.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const char* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace mocaplm
