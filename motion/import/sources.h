// Which files an import reads, what their clips are called, and finding a file again in a list of
// names.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace mocaplm {

struct SourceFile {
  std::filesystem::path path;  // as reached from SRC
  std::string below;           // from SRC's own name on: "bandai-1/walk.bvh"
  std::string name;            // of the clip, unique

  std::string folder() const;  // the name of the folder it lies in
};

struct Sources {
  std::vector<SourceFile> files;  // sorted by path within each SRC
  std::size_t ignored = 0;        // other files in the folders
};

// Files as given, folders searched to the bottom for .npz, .pkl, .bvh and .trc, and for .npy and
// .csv that hold positions of joints; each file once, shape.npz (which holds no motion) and links
// to folders left out. Names are stems; those that several files, or `taken`, share get their
// folders' names in front, as do the others of their folder. Throws DataError for what is not
// there, UsageError for a file that is given itself and has another extension.
Sources find_sources(const std::vector<std::string>& given, const std::set<std::string>& taken);

// Such a name with nothing in it that a file's name cannot have, and of its length.
std::string clip_name(std::string name);

// A list of file names as people write them: a name, with or without folders before it, with or
// without the extension.
class PathList {
 public:
  // `line` is where the list says it; DataError when a name is there twice. Returns its index.
  std::size_t add(const std::string& name, const std::string& file, std::size_t line);
  // The index of the longest name that `source`'s path ends with, or that is its clip's name.
  std::optional<std::size_t> find(const SourceFile& source) const;
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::map<std::string, std::size_t> index_;
  std::vector<std::string> names_;
};

}  // namespace mocaplm
