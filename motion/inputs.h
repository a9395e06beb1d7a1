// What commands are given to read: motion files, parts of them, clips of dataset folders.
//   walk.bvh  walk.bvh:1.5-3  duo.pkl#left  duo.pkl#left:1.5-3  dances  dances#walk  dances#walk:2-
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "motion/clip_range.h"

namespace mocaplm {

struct MotionInput {
  std::string text;  // a file, FILE:from-to, FILE#PART:from-to, or so a clip of the dataset
  std::string name;  // what a file made of it may be called: "walk", of a part "walk_1.5-3.6"
  std::shared_ptr<const Dataset> dataset;  // null for a file

  // Which clip of the dataset; null for a file.
  const DatasetEntry* entry() const;
  // The clip's own file.
  std::filesystem::path file() const;
};

// One for each file, and for each clip of a dataset folder, or for those of `clips` (names, with
// :from-to for a part) that are in it. Throws UsageError for names that no folder has and when
// `reading` says what only files need and there is none, DataError for files that are not there and
// for folders that are no dataset.
std::vector<MotionInput> find_motions(const std::vector<std::string>& inputs,
                                      const std::vector<std::string>& clips,
                                      const MotionReading& reading = {});

// What names one motion alone. Throws as find_motions does, and UsageError for a folder of several.
MotionInput find_motion(const std::string& input, const MotionReading& reading = {});

// All their files.
std::vector<std::filesystem::path> files_of(const std::vector<MotionInput>& inputs);

// Throws as read_clip_range does. The entry lives as long as the input's dataset.
RangedClip read_motion(const MotionInput& input, const MotionReading& reading);

struct NamedMotion {
  std::string text, name;  // as MotionInput's, of this motion alone
  RangedClip read;
};

// All motions of a file with several people or takes, named "duo_left" or "duo_left_1.5-3"; the one
// of any other. Throws as read_clip_ranges does.
std::vector<NamedMotion> read_motions(const MotionInput& input, const MotionReading& reading);

// An input for each motion of a file with several; else the input itself. Reads the file.
std::vector<MotionInput> parts_of(const MotionInput& input, const MotionReading& reading);

// The one motion that a text names, for who needs nothing else.
Clip read_one_motion(const std::string& text, const MotionReading& reading = {});

}  // namespace mocaplm
