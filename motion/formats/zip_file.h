// Zip archives as numpy writes them: stored or deflated entries, read one by one with every size
// checked.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/files.h"

namespace mocaplm {

class ZipReader {
 public:
  // Throws DataError when the file is no zip archive or its directory is damaged.
  explicit ZipReader(const std::filesystem::path& path);
  ~ZipReader();

  bool has(const std::string& entry) const;
  // All entry names, at most the first 1000.
  std::vector<std::string> names() const;
  // The bytes of an entry, its checksum verified. Throws DataError naming the entry when it is
  // missing, over 512 MiB, encrypted, compressed by anything but deflate, damaged, or when its
  // announced size cannot be true or would blow up a small file (a zip bomb: over 16 MiB at more
  // than 100 to 1).
  std::string read(const std::string& entry) const;

 private:
  struct Archive;
  std::unique_ptr<Archive> archive_;
};

// Writes the entries in this order, stored, all dated 1980-01-01: the same entries give the same
// bytes.
void write_zip(const std::filesystem::path& path,
               const std::vector<std::pair<std::string, std::string>>& entries,
               Flush flush = Flush::now);

}  // namespace mocaplm
