// The page of a training run: motions made on the way, how loss and learning rate went, and the
// settings.
#pragma once

#include <filesystem>

#include "viewer/page.h"

namespace mocaplm {

// From RUN/log.jsonl, RUN/samples/ and RUN/settings.json, as `train` writes them; a build without
// three.js leaves the samples out. Throws DataError when the log
// has no line or is not what `train` writes.
Page training_page(const std::filesystem::path& run);

}  // namespace mocaplm
