// Motion files of any known format become a dataset.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/table.h"
#include "motion/dataset_write.h"
#include "motion/formats/formats.h"
#include "motion/import/config.h"
#include "motion/import/limb_errors.h"
#include "motion/import/posture_summary.h"
#include "motion/import/troubles.h"

namespace mocaplm {

struct ImportJob {
  std::vector<std::string> sources;
  std::filesystem::path out;
  Existing existing = Existing::refuse;
  bool strict = false;       // stop at the first broken file
  std::int64_t threads = 0;  // 0: all cores
  // What reads a file.
  std::function<std::vector<ReadMotion>(const std::filesystem::path&, const ReadOptions&)> read =
      read_clips;
};

struct BrokenFile {
  std::string file, reason;
};

struct ImportReport {
  Dataset dataset;                  // as written
  std::size_t imported = 0;         // clips that this import added
  std::size_t ignored = 0;          // files in the folders that are no motion files
  std::vector<BrokenFile> broken;   // left out
  std::vector<FileRemark> remarks;  // of the readers, and what is unlikely; in the files' order
  std::vector<std::vector<std::string>> duplicates;  // clips with exactly the same motion
  std::vector<std::string> warnings;
  LimbErrors limbs;
  PostureSummary figures;
};

// Reads every file, on all cores and holding one file's clips for each, and writes the dataset. A
// file of several people or takes gives as many clips, named STEM_PART, of one group and with the
// file's labels. Broken files are left out and reported, the first of each kind of trouble on
// stderr at once; with `strict` the first one is thrown, and nothing is written. Throws UsageError
// and DataError for whatever makes the whole import impossible, also when no file is sound.
ImportReport import_motion(const ImportConfig& config, const ImportJob& job);

// Clips, minutes, rates and groups of each split; labels with their values.
Table split_table(const Dataset& dataset);
Table label_table(const Dataset& dataset);
// What was left out and what was remarked, one line a kind of trouble (troubles.h).
std::vector<std::string> left_out_lines(const ImportReport& report);
std::vector<std::string> remark_lines(const ImportReport& report);
// All of the report as JSON, every broken file and remark by itself.
Json report_json(const ImportReport& report);

}  // namespace mocaplm
