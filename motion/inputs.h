// What commands are given to read: motion files, parts of them, clips of dataset folders.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "motion/clip_range.h"

namespace mocaplm {

struct MotionInput {
  std::string text;  // a file, FILE:from-to, or so a clip of the dataset
  std::string name;  // what a file made of it may be called: "walk", of a part "walk_1.5-3.6"
  std::shared_ptr<const Dataset> dataset;  // null for a file

  // The clip's own file.
  std::filesystem::path file() const;
};

// One for each file, and for each clip of a dataset folder, or for those of `clips` (names, with
// :from-to for a part) that are in it. Throws UsageError for names that no folder has, DataError
// for files that are not there and for folders that are no dataset.
std::vector<MotionInput> find_motions(const std::vector<std::string>& inputs,
                                      const std::vector<std::string>& clips);

// All their files.
std::vector<std::filesystem::path> files_of(const std::vector<MotionInput>& inputs);

// Throws as read_clip_range does. The entry lives as long as the input's dataset.
RangedClip read_motion(const MotionInput& input, const ReadOptions& options);

}  // namespace mocaplm
