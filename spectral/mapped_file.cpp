#include "spectral/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/error.h"

namespace mocaplm {

MappedFile::MappedFile(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& what) { throw DataError(in_file(path.string()), what); };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(std::string("cannot be opened: ") + std::strerror(errno));
  struct stat about {};
  const bool regular = ::fstat(descriptor, &about) == 0 && S_ISREG(about.st_mode);
  void* data = MAP_FAILED;
  if (regular && about.st_size > 0) {
    size_ = static_cast<std::size_t>(about.st_size);
    data = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor, 0);
  }
  const std::string reason = std::strerror(errno);
  ::close(descriptor);
  if (!regular) fail("is not a regular file");
  if (size_ == 0) fail("is empty");
  if (data == MAP_FAILED) fail("cannot be mapped into memory: " + reason);
  data_ = static_cast<const char*>(data);
}

MappedFile::~MappedFile() {
  ::munmap(const_cast<char*>(data_), size_);
}

}  // namespace mocaplm
