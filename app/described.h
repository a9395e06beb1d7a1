// What `info` says about a path.
#pragma once

#include <filesystem>
#include <vector>

#include "common/table.h"

namespace mocaplm {

// One table or more for a motion file, a dataset's folder or dataset.json, a tokenizer.json, an
// emulator's file, a model's or training run's folder or config.json. Throws DataError for anything
// else, and where the file is not sound.
std::vector<Table> describe_path(const std::filesystem::path& path);

}  // namespace mocaplm
