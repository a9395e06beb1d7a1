// Motion files of any known format become a dataset.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/table.h"
#include "motion/dataset_write.h"
#include "motion/import/config.h"
#include "motion/import/limb_errors.h"

namespace mocaplm {

struct ImportJob {
  std::vector<std::string> sources;
  std::filesystem::path out;
  Existing existing = Existing::refuse;
  bool strict = false;       // stop at the first broken file
  std::int64_t threads = 0;  // 0: all cores
};

struct BrokenFile {
  std::string file, reason;
};

struct ImportReport {
  Dataset dataset;                 // as written
  std::size_t imported = 0;        // clips that this import added
  std::size_t ignored = 0;         // files in the folders that are no motion files
  std::vector<BrokenFile> broken;  // left out
  std::vector<std::vector<std::string>> duplicates;  // clips with exactly the same motion
  std::vector<std::string> warnings;
  LimbErrors limbs;
};

// Reads every file, on all cores and holding one clip for each, and writes the dataset. Broken
// files are named on stderr, left out and reported; with `strict` the first one is thrown, and
// nothing is written. Throws UsageError and DataError for whatever makes the whole import
// impossible, also when no file is sound.
ImportReport import_motion(const ImportConfig& config, const ImportJob& job);

// Clips, minutes, rates and groups of each split; labels with their values.
Table split_table(const Dataset& dataset);
Table label_table(const Dataset& dataset);
// All of the report as JSON.
Json report_json(const ImportReport& report);

}  // namespace mocaplm
