// The page of a training run: how loss and learning rate went, and the settings.
#pragma once

#include <filesystem>

#include "viewer/page.h"

namespace mocaplm {

// From RUN/log.jsonl and RUN/settings.json, as `train` writes them. Throws DataError when the log
// has no line or is not what `train` writes.
Page training_page(const std::filesystem::path& run);

}  // namespace mocaplm
