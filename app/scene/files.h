// What assimp may open: the one file, in memory, and for a .gltf its buffers beside it.
#pragma once

#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <string>

namespace mocaplm {

// The file itself is opened as `name`, whatever it is called on the disk. With `folder`, files
// below it by relative names; everything else is not there.
class SceneFiles : public Assimp::IOSystem {
 public:
  SceneFiles(std::string name, const std::string& bytes, std::filesystem::path folder)
      : name_(std::move(name)), bytes_(bytes), folder_(std::move(folder)) {}

  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

  // The last name that was asked for in vain; empty when there was none.
  const std::string& missing() const { return missing_; }

 private:
  // Where a file beside the main one lies; empty when it must not be opened.
  std::filesystem::path beside(const std::string& file) const;

  std::string name_;
  const std::string& bytes_;
  std::filesystem::path folder_;
  mutable std::string missing_;
};

}  // namespace mocaplm
