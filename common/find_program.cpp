#include "common/find_program.h"

#include <unistd.h>

#include <cstdlib>

#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm {

fs::path find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path == nullptr ? "" : path, ':')) {
    const fs::path file = fs::path(folder) / name;
    std::error_code error;
    if (!folder.empty() && fs::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0)
      return file;
  }
  return {};
}

}  // namespace mocaplm
