// What is said about each file besides its motion: labels, group, the true rate, frames to leave
// out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/import/config.h"
#include "motion/import/sources.h"

namespace mocaplm {

struct FileFacts {
  Labels labels;              // of AIST++'s names, then the folder, the expression and the table
  std::string group;          // "" when none is given: the clip is a group of its own
  std::optional<double> fps;  // overrides the file's
  std::int64_t drop_first = 0;
};

struct Facts {
  std::vector<FileFacts> files;       // one for each source, in order
  std::vector<std::string> warnings;  // tables and expressions that did not match everything
};

// Throws UsageError for bad expressions, DataError for bad tables.
Facts gather_facts(const ImportConfig& config, const std::vector<SourceFile>& sources);

}  // namespace mocaplm
