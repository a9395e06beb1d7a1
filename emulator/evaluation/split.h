// Clips to fit an emulator to, and unseen others to test it against.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emulator/emulator.h"
#include "motion/dataset.h"

namespace mocaplm {

// The fewest clips that a scheme can be fitted to, and that a sample can have.
constexpr std::size_t kFewestToFit = kFewestMotions, kFewestToTest = 2;

struct ClipSplit {
  std::vector<DatasetEntry> fit, test;  // each by name
};

// Clips in random order, those of one group together, until `test_share` of them, in (0, 1), are in
// the test set; the rest is to fit. The same seed and class give the same split. Throws DataError,
// naming `what` ("content walk of DATASET"), when there are too few clips for kFewestToFit and
// kFewestToTest or too few groups.
ClipSplit split_clips(const std::vector<DatasetEntry>& entries, double test_share,
                      std::uint64_t seed, const std::string& what);

}  // namespace mocaplm
