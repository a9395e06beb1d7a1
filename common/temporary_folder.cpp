#include "common/temporary_folder.h"

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "common/error.h"

namespace fs = std::filesystem;

namespace mocaplm {

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  if (error)
    throw DataError(in_file("TMPDIR"), "names no folder for temporary files: " + error.message());
  std::string name = (parent / "mocaplm-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw DataError(in_file(name),
                    std::string("cannot be made, a folder for a while: ") + std::strerror(errno));
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace mocaplm
