// Reading whole files with a size limit, and writing so that a failure never costs what was there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mocaplm {

// The largest file read into memory at once; larger ones are refused by name.
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 30;

// Returns the file's bytes. Throws DataError when it is missing, a directory, unreadable or too
// large.
std::string read_file(const std::filesystem::path& path, std::uintmax_t max_bytes = kMaxFileBytes);

// The first bytes, at most `count`, of a file of any size: enough to tell one format from another.
std::string read_head(const std::filesystem::path& path, std::uintmax_t count);

// When what was written is safe from a loss of power: `now`, before the file takes its name, or
// `later`, for files of a folder that is flushed as a whole with flush_files_under.
enum class Flush { now, later };

// Writes beside `path` and renames over it, so a reader sees the old file or the new one, never
// half of one. Creates the parent directory. Throws DataError when the disk refuses.
void write_file(const std::filesystem::path& path, std::string_view bytes,
                Flush flush = Flush::now);

// The same for a writer that needs a path of its own: `fill` writes the temporary file.
void write_file_with(const std::filesystem::path& path,
                     const std::function<void(const std::filesystem::path&)>& fill,
                     Flush flush = Flush::now);

// Brings all that was written to the folder's file system to the disk: one wait in place of one for
// each file.
void flush_files_under(const std::filesystem::path& folder);

// Throws DataError when write_file would fail now, so that a command can say so before hours of
// work. Creates the parent directory; an empty path means no file and passes.
void check_writable(const std::filesystem::path& path);

// Throws UsageError when one of the files that a command writes would replace one that it reads, or
// another one that it writes, in whatever way they are named. Empty paths mean no file and pass.
void check_outputs(const std::vector<std::filesystem::path>& written,
                   const std::vector<std::filesystem::path>& read);

// Fills `temporary` (a fresh directory beside `path`), then swaps it in for `path`. An old
// directory is replaced only when `may_replace(path)` is true or it is empty; otherwise DataError,
// nothing touched.
void write_directory_with(const std::filesystem::path& path,
                          const std::function<bool(const std::filesystem::path&)>& may_replace,
                          const std::function<void(const std::filesystem::path&)>& fill);

}  // namespace mocaplm
