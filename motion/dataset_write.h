// Making a dataset on disk: all of it or nothing, and never at the cost of what was there.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "motion/dataset.h"

namespace mocaplm {

// What to do with a dataset that is already there.
enum class Existing { refuse, replace, append };

// `fill` stores clips below the directory it is given and returns the dataset that lists them; then
// the directory takes the place of `out`. For `append` the old dataset's files are in the directory
// already. Throws UsageError when `out` holds a dataset and `existing` is refuse, DataError when it
// holds anything that is not part of a dataset; then, and when `fill` throws, nothing has changed.
void write_dataset(const std::filesystem::path& out, Existing existing,
                   const std::function<Dataset(const std::filesystem::path&)>& fill);

// The file of a clip relative to the dataset's directory: "clips/NAME.npz".
std::string clip_file(const std::string& name);
// Stores a clip as its entry's file below `directory`; write_dataset brings it to the disk with all
// others.
void store_clip(const std::filesystem::path& directory, const DatasetEntry& entry,
                const Clip& clip);

// Whether `directory` is empty, absent or holds a sound dataset and nothing that is not listed in
// it.
bool holds_only_a_dataset(const std::filesystem::path& directory);

}  // namespace mocaplm
