#include "motion/formats/zip_file.h"

#include <zip.h>

#include <algorithm>

#include "common/error.h"
#include "common/files.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr std::uint64_t kMaxEntry = std::uint64_t{512} << 20;
// Below this size a high ratio does no harm; above it real motion never reaches 100 to 1.
constexpr std::uint64_t kSmallEntry = std::uint64_t{16} << 20;
constexpr std::uint64_t kMaxRatio = 100;
// Deflate cannot do better than 1032 to 1.
constexpr std::uint64_t kDeflateRatio = 1032;
constexpr zip_uint16_t kDosDate1980 = 1 << 5 | 1;

std::string error_text(int code) {
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

std::string of_bytes(std::uint64_t bytes) {
  return std::to_string(bytes) + " bytes";
}

}  // namespace

struct ZipReader::Archive {
  std::string file;
  std::uint64_t file_bytes = 0;
  zip_t* zip = nullptr;

  ~Archive() {
    if (zip != nullptr) zip_discard(zip);
  }
  std::string place(const std::string& entry) const { return file + ": " + entry; }
  // Throws when what the directory says of an entry cannot be true, or is more than is read.
  void check(const zip_stat_t& stat, const std::string& entry) const;
};

void ZipReader::Archive::check(const zip_stat_t& stat, const std::string& entry) const {
  const std::uint64_t needed = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD;
  const auto fail = [&](const std::string& message) {
    throw DataError(in_file(place(entry)), message);
  };
  if ((stat.valid & needed) != needed) fail("the archive does not say how large it is");
  if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE)
    fail("is encrypted");
  if (stat.comp_method != ZIP_CM_STORE && stat.comp_method != ZIP_CM_DEFLATE)
    fail("is compressed by method " + std::to_string(stat.comp_method) +
         ", expected stored (0) or deflated (8) as numpy writes it");
  const bool stored = stat.comp_method == ZIP_CM_STORE;
  if (stat.comp_size > file_bytes || (stored && stat.size != stat.comp_size) ||
      (!stored && stat.size / kDeflateRatio > stat.comp_size))
    fail("claims " + of_bytes(stat.size) + " from " + of_bytes(stat.comp_size) + " in a file of " +
         of_bytes(file_bytes) + ", which cannot be: the file is damaged");
  if (stat.size > kMaxEntry)
    fail("has " + of_bytes(stat.size) + ", more than the limit of " + of_bytes(kMaxEntry) +
         "; cut it into several clips");
  if (stat.size > kSmallEntry && stat.size / kMaxRatio > stat.comp_size)
    fail("would grow from " + of_bytes(stat.comp_size) + " to " + of_bytes(stat.size) +
         ": refused as a zip bomb");
}

ZipReader::ZipReader(const fs::path& path) : archive_(std::make_unique<Archive>()) {
  archive_->file = path.string();
  if (read_head(path, 2) != "PK")
    throw DataError(at_byte(path.string(), 0),
                    "is not an .npz archive: it does not begin with \"PK\" as zip files do");
  std::error_code ignored;
  archive_->file_bytes = fs::file_size(path, ignored);
  int code = 0;
  archive_->zip = zip_open(path.c_str(), ZIP_RDONLY, &code);
  if (archive_->zip == nullptr)
    throw DataError(in_file(path.string()), "its zip directory cannot be read (" +
                                                error_text(code) +
                                                "): the file is truncated or damaged");
}

ZipReader::~ZipReader() = default;

bool ZipReader::has(const std::string& entry) const {
  return zip_name_locate(archive_->zip, entry.c_str(), 0) >= 0;
}

std::vector<std::string> ZipReader::names() const {
  std::vector<std::string> names;
  const zip_int64_t count = std::min<zip_int64_t>(zip_get_num_entries(archive_->zip, 0), 1000);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(archive_->zip, static_cast<zip_uint64_t>(i), 0);
    if (name == nullptr) continue;
    names.emplace_back(name);
    for (char& c : names.back())  // a message must not carry control sequences
      if (c >= 0 && c < ' ') c = '?';
  }
  return names;
}

std::string ZipReader::read(const std::string& entry) const {
  const std::string place = archive_->place(entry);
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat(archive_->zip, entry.c_str(), 0, &stat) != 0)
    throw DataError(in_file(place), "no such entry in the archive");
  archive_->check(stat, entry);
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> in(
      zip_fopen_index(archive_->zip, stat.index, 0), zip_fclose);
  if (in == nullptr)
    throw DataError(in_file(place),
                    std::string("cannot be opened: ") + zip_strerror(archive_->zip));
  std::string bytes(stat.size, '\0');
  std::size_t done = 0;
  // One read more than needed: libzip verifies the checksum when it meets the end.
  char extra = 0;
  for (;;) {
    const bool full = done == bytes.size();
    const zip_int64_t got = full ? zip_fread(in.get(), &extra, 1)
                                 : zip_fread(in.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0 || (full && got > 0))
      throw DataError(at_byte(place, done),
                      "is damaged: " + (got < 0 ? std::string(zip_file_strerror(in.get()))
                                                : "it is longer than " + of_bytes(bytes.size())));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  if (done != bytes.size())
    throw DataError(at_byte(place, done), "ends early; expected " + of_bytes(bytes.size()));
  return bytes;
}

namespace {

struct FreeSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};
using Source = std::unique_ptr<zip_source_t, FreeSource>;

bool add_entry(zip_t* zip, const std::string& name, const std::string& bytes) {
  zip_source_t* source = zip_source_buffer(zip, bytes.data(), bytes.size(), 0);
  if (source == nullptr) return false;
  const zip_int64_t index = zip_file_add(zip, name.c_str(), source, ZIP_FL_OVERWRITE);
  if (index < 0) {
    zip_source_free(source);
    return false;
  }
  const auto at = static_cast<zip_uint64_t>(index);
  return zip_set_file_compression(zip, at, ZIP_CM_STORE, 0) == 0 &&
         zip_file_set_dostime(zip, at, 0, kDosDate1980, 0) == 0;
}

std::string read_all(zip_source_t* source) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  std::string bytes;
  if (zip_source_open(source) != 0) return bytes;
  if (zip_source_stat(source, &stat) == 0 && (stat.valid & ZIP_STAT_SIZE) != 0) {
    bytes.resize(stat.size);
    if (zip_source_read(source, bytes.data(), bytes.size()) !=
        static_cast<zip_int64_t>(bytes.size()))
      bytes.clear();
  }
  zip_source_close(source);
  return bytes;
}

}  // namespace

// The archive is made in memory and written by our own code: libzip's own writing of files said
// "Read-only archive" once in many runs when two threads wrote archives side by side.
void write_zip(const fs::path& path,
               const std::vector<std::pair<std::string, std::string>>& entries, Flush flush) {
  const auto fail = [&](const std::string& reason) {
    throw DataError(in_file(path.string()), "cannot be made: " + reason);
  };
  zip_error_t error;
  zip_error_init(&error);
  const Source archive(zip_source_buffer_create(nullptr, 0, 0, &error));
  if (archive == nullptr) fail(zip_error_strerror(&error));
  zip_t* zip = zip_open_from_source(archive.get(), ZIP_TRUNCATE, &error);
  if (zip == nullptr) fail(zip_error_strerror(&error));
  zip_source_keep(archive.get());  // the open archive takes over the first reference
  bool good = true;
  for (const auto& [name, bytes] : entries) good = good && add_entry(zip, name, bytes);
  if (!good || zip_close(zip) != 0) {
    const std::string reason = zip_strerror(zip);
    zip_discard(zip);
    fail(reason);
  }
  const std::string bytes = read_all(archive.get());
  if (bytes.empty()) fail("libzip does not give back what it wrote");
  write_file(path, bytes, flush);
}

}  // namespace mocaplm
