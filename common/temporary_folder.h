// A folder of one's own for a while.
#pragma once

#include <filesystem>
#include <string>

namespace mocaplm {

// A fresh folder that nobody else may look into, in the system's folder for temporary files; at the
// end it is removed with all that is in it. Throws DataError when it cannot be made.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace mocaplm
