// From what a user names (motion files, dataset directories) to a page.
#pragma once

#include <string>
#include <vector>

#include "motion/reading.h"
#include "viewer/page.h"

namespace mocaplm {

// A page with more figures would be slow in most browsers.
constexpr std::size_t kMaxPageMotions = 48;
// A dataset directory without chosen clips shows this many of its first ones.
constexpr std::size_t kDatasetPreview = 6;

struct ViewOptions {
  // As find_motions (motion/inputs.h) takes them.
  std::vector<std::string> inputs;          // motion files and dataset directories
  std::vector<std::string> clips;           // names of clips in the dataset directories
  std::vector<std::string> joints, trails;  // joints or groups (parse_joints); may be empty
  std::string title;                        // empty: made from the names
  std::string note;                         // beside the title; procedural datasets say so anyway
  MotionReading read;                       // for files; a dataset's clips are already read
};

// Reads the clips in the order given. Throws UsageError (nothing to show, too many, unknown joints,
// unknown clip names with the nearest known one) and DataError (as read_clip and load_dataset).
// `remarks` receives sentences for the user, such as how much of a dataset is shown.
Page open_page(const ViewOptions& options, std::vector<std::string>* remarks = nullptr);

// Throws UsageError unless the page's name ends in .html or .htm: a slip must not replace a motion.
void check_page_path(const std::filesystem::path& path);

}  // namespace mocaplm
