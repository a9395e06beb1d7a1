// The same trouble in many files is one message: how often, and where for example.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "motion/formats/remark.h"

namespace mocaplm {

// A remark on a file, or why it was left out.
struct FileRemark {
  std::string file;
  Remark remark;
};

// What is left of an error's message when the file, numbers, quoted words and joints' names are
// taken out: equal for the same trouble in other files.
std::string kind_of_error(const std::string& message, const std::string& file);

// Troubles by kind, in the order in which the kinds first appear.
class Troubles {
 public:
  // True when it is the first of its kind.
  bool add(const FileRemark& trouble);
  bool empty() const { return groups_.empty(); }
  // One sentence a kind, without a full stop: "FILE: TEXT", and of several files "75 files: KIND;
  // for example FILE: TEXT". A file counts once for a kind.
  std::vector<std::string> lines() const;
  // The same for messages of errors, which name their file themselves: "75 files for the same
  // reason; for example MESSAGE".
  std::vector<std::string> error_lines() const;

 private:
  struct Group {
    FileRemark first;
    std::string last_file;
    std::size_t files = 0;
  };
  std::vector<Group> groups_;
  std::map<std::string, std::size_t> index_;  // of a kind's group
};

}  // namespace mocaplm
