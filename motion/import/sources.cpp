#include "motion/import/sources.h"

#include <algorithm>

#include "common/error.h"
#include "motion/formats/formats.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr std::size_t kMaxFileName = 180;  // bytes: a file name has 255, and needs an extension

fs::path plain(const fs::path& path) {
  const fs::path normal = path.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// "bandai-1/walk.bvh" for the file /data/bandai-1/walk.bvh below the given /data/bandai-1.
std::string below(const fs::path& given, const fs::path& path) {
  const fs::path base = plain(fs::absolute(given)).parent_path();
  return fs::absolute(path).lexically_normal().lexically_relative(base).generic_string();
}

bool holds_motion(const fs::path& path) {
  return looks_like_motion(path) && path.filename() != "shape.npz";
}

std::vector<fs::path> search(const fs::path& folder, std::size_t& ignored) {
  std::vector<fs::path> found;
  try {
    for (const fs::directory_entry& item : fs::recursive_directory_iterator(folder)) {
      if (item.is_directory()) continue;
      if (item.is_regular_file() && holds_motion(item.path()))
        found.push_back(item.path());
      else
        ++ignored;
    }
  } catch (const fs::filesystem_error& error) {
    throw DataError(in_file(error.path1().empty() ? folder.string() : error.path1().string()),
                    "cannot be searched: " + error.code().message());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// The stem with the names of `depth` folders before it.
std::string name_with_folders(const fs::path& path, int depth) {
  std::string name = path.stem().string();
  fs::path folder = plain(fs::absolute(path)).parent_path();
  for (; depth > 0 && folder.has_filename(); --depth, folder = folder.parent_path())
    name = folder.filename().string() + "_" + name;
  return clip_name(name);
}

void give_names(std::vector<SourceFile>& files, std::set<std::string> taken) {
  std::vector<std::size_t> unnamed(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) unnamed[i] = i;
  for (int depth = 0; depth < 4 && !unnamed.empty(); ++depth) {
    std::map<std::string, int> count;
    for (const std::size_t i : unnamed) ++count[name_with_folders(files[i].path, depth)];
    // One clash in a folder and all its files are called by the folder: salsa_01, salsa_02, ...
    std::set<fs::path> folders;
    for (const std::size_t i : unnamed) {
      const std::string name = name_with_folders(files[i].path, depth);
      if (count[name] > 1 || taken.count(name) > 0) folders.insert(files[i].path.parent_path());
    }
    std::vector<std::size_t> clashing;
    for (const std::size_t i : unnamed) {
      if (folders.count(files[i].path.parent_path()) > 0)
        clashing.push_back(i);
      else
        files[i].name = name_with_folders(files[i].path, depth);
    }
    for (const std::size_t i : unnamed)
      if (!files[i].name.empty()) taken.insert(files[i].name);
    unnamed = clashing;
  }
  for (const std::size_t i : unnamed) {
    const std::string stem = clip_name(files[i].path.stem().string());
    int number = 2;
    do files[i].name = stem + "_" + std::to_string(number++);
    while (!taken.insert(files[i].name).second);
  }
}

}  // namespace

std::string clip_name(std::string name) {
  for (char& c : name)
    if (static_cast<unsigned char>(c) < 32 || c == 127 || c == '/') c = '_';
  if (!name.empty() && name[0] == '.') name[0] = '_';
  if (name.size() > kMaxFileName) name.resize(kMaxFileName);
  return name.empty() ? "clip" : name;
}

std::string SourceFile::folder() const {
  return plain(fs::absolute(path)).parent_path().filename().string();
}

Sources find_sources(const std::vector<std::string>& given, const std::set<std::string>& taken) {
  Sources sources;
  std::set<fs::path> seen;
  const auto add = [&](const fs::path& from, const fs::path& path) {
    if (seen.insert(fs::weakly_canonical(path)).second)
      sources.files.push_back({path, below(from, path), ""});
  };
  for (const std::string& text : given) {
    const fs::path path(text);
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw DataError(in_file(text), "no such file or folder");
    if (fs::is_directory(status)) {
      for (const fs::path& file : search(path, sources.ignored)) add(path, file);
    } else if (!is_motion_file(path)) {
      throw UsageError(
          text +
          ": not a motion file by its extension, expected .npz, .pkl, .bvh, .npy, .csv or .trc");
    } else {
      add(path, path);
    }
  }
  give_names(sources.files, taken);
  return sources;
}

std::size_t PathList::add(const std::string& name, const std::string& file, std::size_t line) {
  if (name.empty()) throw DataError(at_line(file, line), "a name is missing");
  const std::string key = fs::path(name).lexically_normal().generic_string();
  if (!index_.emplace(key, names_.size()).second)
    throw DataError(at_line(file, line), "\"" + name + "\" is there twice");
  names_.push_back(name);
  return names_.size() - 1;
}

std::optional<std::size_t> PathList::find(const SourceFile& source) const {
  const fs::path path = fs::absolute(source.path).lexically_normal();
  const std::string full = path.generic_string();
  const std::size_t extension = path.extension().string().size();
  for (std::size_t at = 0;; ++at) {
    for (const std::string& key :
         {full.substr(at), full.substr(at, full.size() - at - extension)}) {
      const auto found = index_.find(key);
      if (found != index_.end()) return found->second;
    }
    at = full.find('/', at);
    if (at == std::string::npos) break;
  }
  const auto found = index_.find(source.name);
  if (found == index_.end()) return std::nullopt;
  return found->second;
}

}  // namespace mocaplm
