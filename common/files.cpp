#include "common/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>

#include "common/error.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::string reason() {
  return std::strerror(errno);
}

fs::path beside(const fs::path& path, const char* suffix) {
  fs::path plain = path.has_filename() ? path : path.parent_path();
  return plain.parent_path() /
         ("." + plain.filename().string() + "." + suffix + std::to_string(::getpid()));
}

void make_parent(const fs::path& path) {
  std::error_code error;
  const fs::path parent = path.parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (error)
    throw DataError(in_file(parent.string()), "cannot create the folder: " + error.message());
}

// Puts `fresh` in the place of `path`; what was there ends up at `old`. In one step where the file
// system can exchange two names, so that no moment exists without a folder at `path`.
void swap_in(const fs::path& fresh, const fs::path& path, const fs::path& old) {
  if (fs::exists(path)) {
    if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, path.c_str(), RENAME_EXCHANGE) == 0) {
      fs::rename(fresh, old);
      return;
    }
    fs::rename(path, old);
  }
  fs::rename(fresh, path);
}

void flush_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

// From the root and with links followed, whether the file exists or not: equal for two names of one
// file.
fs::path real_path(const fs::path& path) {
  std::error_code error;
  const fs::path found = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : found;
}

// The size of a regular file; throws DataError for everything else.
std::uintmax_t size_of_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw DataError(in_file(path.string()), "no such file");
  if (fs::is_directory(status))
    throw DataError(in_file(path.string()), "is a folder, expected a file");
  if (!fs::is_regular_file(status))
    throw DataError(in_file(path.string()), "is not a regular file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw DataError(in_file(path.string()), "cannot be read: " + error.message());
  return size;
}

std::string read_bytes(const fs::path& path, std::uintmax_t count) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw DataError(in_file(path.string()), "cannot be opened: " + reason());
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  if (static_cast<std::uintmax_t>(in.gcount()) != count)
    throw DataError(at_byte(path.string(), static_cast<std::size_t>(in.gcount())),
                    "reading stopped: " + reason());
  return bytes;
}

}  // namespace

std::string read_file(const fs::path& path, std::uintmax_t max_bytes) {
  const std::uintmax_t size = size_of_file(path);
  if (size > max_bytes)
    throw DataError(in_file(path.string()), "has " + std::to_string(size) +
                                                " bytes, more than the limit of " +
                                                std::to_string(max_bytes));
  return read_bytes(path, size);
}

std::string read_head(const fs::path& path, std::uintmax_t count) {
  return read_bytes(path, std::min(count, size_of_file(path)));
}

void write_file(const fs::path& path, std::string_view bytes, Flush flush) {
  const auto fill = [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) throw DataError(in_file(path.string()), "cannot be written: " + reason());
  };
  write_file_with(path, fill, flush);
}

void write_file_with(const fs::path& path, const std::function<void(const fs::path&)>& fill,
                     Flush flush) {
  make_parent(path);
  if (fs::is_directory(path))
    throw DataError(in_file(path.string()), "is a folder, cannot write a file there");
  const fs::path temporary = beside(path, "new");
  try {
    fill(temporary);
    if (flush == Flush::now) flush_to_disk(temporary);
    std::error_code error;
    fs::rename(temporary, path, error);
    if (error) throw DataError(in_file(path.string()), "cannot be written: " + error.message());
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void flush_files_under(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return;
  ::syncfs(descriptor);
  ::close(descriptor);
}

void check_writable(const fs::path& path) {
  if (path.empty()) return;
  make_parent(path);
  if (fs::is_directory(path))
    throw DataError(in_file(path.string()), "is a folder, cannot write a file there");
  const fs::path probe = beside(path, "probe");
  const int descriptor = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) throw DataError(in_file(path.string()), "cannot be written: " + reason());
  ::close(descriptor);
  ::unlink(probe.c_str());
}

void check_outputs(const std::vector<fs::path>& written, const std::vector<fs::path>& read) {
  std::set<fs::path> sources, results;
  for (const fs::path& file : read)
    if (!file.empty()) sources.insert(real_path(file));
  for (const fs::path& file : written) {
    if (file.empty()) continue;
    const fs::path real = real_path(file);
    if (sources.count(real) > 0)
      throw UsageError(file.string() + " would replace a file that is read: give another name");
    if (!results.insert(real).second)
      throw UsageError(file.string() + " would be written twice: give another name");
  }
}

void write_directory_with(const fs::path& path,
                          const std::function<bool(const fs::path&)>& may_replace,
                          const std::function<void(const fs::path&)>& fill) {
  make_parent(path);
  if (fs::exists(path)) {
    if (!fs::is_directory(path))
      throw DataError(in_file(path.string()), "is a file, expected a folder");
    if (!fs::is_empty(path) && !may_replace(path))
      throw DataError(
          in_file(path.string()),
          "is not empty and was not made by this command; give another folder or remove it");
  }
  const fs::path temporary = beside(path, "new"), old = beside(path, "old");
  std::error_code ignored;
  fs::remove_all(temporary, ignored);
  try {
    fs::create_directories(temporary);
    fill(temporary);
    swap_in(temporary, path, old);
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
