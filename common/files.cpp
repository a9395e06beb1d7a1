#include "common/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/error.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::string reason() {
  return std::strerror(errno);
}

fs::path beside(const fs::path& path, const char* suffix) {
  fs::path plain = path.has_filename() ? path : path.parent_path();
  return plain.parent_path() / ("." + plain.filename().string() + "." + suffix + std::to_string(::getpid()));
}

void make_parent(const fs::path& path) {
  std::error_code error;
  const fs::path parent = path.parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (error) throw DataError(in_file(parent.string()), "cannot create the folder: " + error.message());
}

void flush_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

std::string read_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw DataError(in_file(path.string()), "no such file");
  if (fs::is_directory(status)) throw DataError(in_file(path.string()), "is a folder, expected a file");
  if (!fs::is_regular_file(status)) throw DataError(in_file(path.string()), "is not a regular file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw DataError(in_file(path.string()), "cannot be read: " + error.message());
  if (size > max_bytes)
    throw DataError(in_file(path.string()), "has " + std::to_string(size) + " bytes, more than the limit of " +
                                                std::to_string(max_bytes));
  std::ifstream in(path, std::ios::binary);
  if (!in) throw DataError(in_file(path.string()), "cannot be opened: " + reason());
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size)
    throw DataError(at_byte(path.string(), static_cast<std::size_t>(in.gcount())), "reading stopped: " + reason());
  return bytes;
}

void write_file(const fs::path& path, std::string_view bytes) {
  write_file_with(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) throw DataError(in_file(path.string()), "cannot be written: " + reason());
  });
}

void write_file_with(const fs::path& path, const std::function<void(const fs::path&)>& fill) {
  make_parent(path);
  if (fs::is_directory(path)) throw DataError(in_file(path.string()), "is a folder, cannot write a file there");
  const fs::path temporary = beside(path, "new");
  try {
    fill(temporary);
    flush_to_disk(temporary);
    std::error_code error;
    fs::rename(temporary, path, error);
    if (error) throw DataError(in_file(path.string()), "cannot be written: " + error.message());
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void write_directory_with(const fs::path& path, const std::function<bool(const fs::path&)>& may_replace,
                          const std::function<void(const fs::path&)>& fill) {
  make_parent(path);
  if (fs::exists(path)) {
    if (!fs::is_directory(path)) throw DataError(in_file(path.string()), "is a file, expected a folder");
    if (!fs::is_empty(path) && !may_replace(path))
      throw DataError(in_file(path.string()),
                      "is not empty and was not made by this command; give another folder or remove it");
  }
  const fs::path temporary = beside(path, "new"), old = beside(path, "old");
  std::error_code ignored;
  fs::remove_all(temporary, ignored);
  try {
    fs::create_directories(temporary);
    fill(temporary);
    if (fs::exists(path)) fs::rename(path, old);
    fs::rename(temporary, path);
  } catch (const fs::filesystem_error& error) {
    if (!fs::exists(path) && fs::exists(old)) fs::rename(old, path, ignored);
    fs::remove_all(temporary, ignored);
    throw DataError(in_file(path.string()), std::string("cannot be written: ") + error.what());
  } catch (...) {
    fs::remove_all(temporary, ignored);
    throw;
  }
  fs::remove_all(old, ignored);
}

}  // namespace mocaplm
