// What `info` says about a path.
#pragma once

#include <filesystem>
#include <vector>

#include "common/table.h"

namespace mocaplm {

// A few lines on whatever this program reads or writes: motion files, datasets, tokenizers, models,
// training runs, classifiers, emulators, gesture models, spectral indexes, experiments, settings,
// tables, pages, corpora, recordings. Throws DataError for anything else, and where it is not
// sound.
std::vector<Table> describe_path(const std::filesystem::path& path);

}  // namespace mocaplm
