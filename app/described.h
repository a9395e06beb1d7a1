// What `info` says about a path.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/table.h"
#include "motion/formats/formats.h"

namespace mocaplm {

// A few lines on whatever this program reads or writes: motion files, datasets, tokenizers, models,
// training runs, classifiers, emulators, gesture models, spectral indexes, experiments, settings,
// tables, pages, corpora, recordings. Throws DataError for anything else, and where it is not
// sound.
// `options`: of motion files.
std::vector<Table> describe_path(const std::filesystem::path& path,
                                 const ReadOptions& options = {});

// The same of what a user names as a motion, FILE:from-to, FILE#PART or DATASET#CLIP
// (motion/inputs.h), and of any path.
std::vector<Table> describe_named(const std::string& text, const ReadOptions& options);

}  // namespace mocaplm
