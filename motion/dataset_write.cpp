#include "motion/dataset_write.h"

#include <set>

#include "common/error.h"
#include "common/files.h"
#include "motion/formats/npz.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

bool has_content(const fs::path& directory) {
  return fs::exists(directory) && !(fs::is_directory(directory) && fs::is_empty(directory));
}

void check_existing(const fs::path& out, Existing existing) {
  if (!has_content(out)) return;
  if (!is_dataset(out))
    throw DataError(in_file(out.string()),
                    "is not empty and not a dataset; give another folder or empty this one");
  if (existing == Existing::refuse)
    throw UsageError(out.string() +
                     " is a dataset already: --overwrite replaces it, or give another folder");
  if (!holds_only_a_dataset(out))
    throw DataError(in_file(out.string()),
                    "holds files that its dataset.json does not list; move them away first");
}

// A link costs nothing and is safe: files of a dataset are replaced, never changed.
void carry_over(const fs::path& from, const Dataset& old, const fs::path& to) {
  for (const DatasetEntry& entry : old.entries) {
    fs::create_directories((to / entry.file).parent_path());
    std::error_code error;
    fs::create_hard_link(from / entry.file, to / entry.file, error);
    if (error) fs::copy_file(from / entry.file, to / entry.file);
  }
}

}  // namespace

void write_dataset(const fs::path& out, Existing existing,
                   const std::function<Dataset(const fs::path&)>& fill) {
  check_existing(out, existing);
  const auto may_replace = [&](const fs::path&) { return existing != Existing::refuse; };
  write_directory_with(out, may_replace, [&](const fs::path& directory) {
    std::int64_t version = kDatasetVersion;
    if (existing == Existing::append && has_content(out)) {
      const Dataset old = read_dataset(out);
      carry_over(out, old, directory);
      if (!dataset_trouble(old).empty()) version = old.version;
    }
    fs::create_directories(directory / "clips");
    Dataset dataset = fill(directory);
    dataset.directory = directory;
    dataset.version = version;
    flush_files_under(directory);
    save_dataset(dataset);
  });
}

std::string clip_file(const std::string& name) {
  return "clips/" + name + ".npz";
}

void store_clip(const fs::path& directory, const DatasetEntry& entry, const Clip& clip) {
  write_npz(directory / entry.file, clip, Flush::later);
}

bool holds_only_a_dataset(const fs::path& directory) {
  if (!has_content(directory)) return true;
  if (!is_dataset(directory)) return false;
  std::set<fs::path> own = {"dataset.json", "clips"};
  for (const DatasetEntry& entry : read_dataset(directory).entries)
    for (fs::path path = fs::path(entry.file).lexically_normal(); !path.empty();
         path = path.parent_path())
      own.insert(path);
  for (const fs::directory_entry& item : fs::recursive_directory_iterator(directory))
    if (own.count(item.path().lexically_relative(directory)) == 0) return false;
  return true;
}

}  // namespace mocaplm
