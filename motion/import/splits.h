// Which clips train, validate and test: whole groups, at random but repeatable, in the wished
// shares.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "motion/dataset.h"
#include "motion/import/sources.h"

namespace mocaplm {

// Shares of train, validation and test.
using Shares = std::array<double, 3>;

// "0.8,0.1,0.1": three numbers of 0 or more that sum to 1. Throws UsageError.
Shares parse_shares(const std::string& text);

// Sets `split` of every entry whose split is empty; the others, and with them their groups, stay.
// Groups come in the order of a hash of their name and the seed, and each goes to the split that
// lacks most seconds of motion; where a stratum (equal values of the labels `stratify`) has as many
// groups as there are splits to fill, each gets one. Throws DataError when a group's clips already
// are in two splits.
void assign_splits(std::vector<DatasetEntry>& entries, const Shares& shares,
                   const std::vector<std::string>& stratify, std::uint64_t seed);

// Reads "SPLIT=FILE" lists and sets the split of the clips named there; `sources[i]` belongs to
// `entries[i]`. Returns the shares that are left for clips in no list: a split with a list gets no
// more. Throws UsageError for a bad SPLIT, DataError for names that no clip has or that two lists
// share.
Shares use_split_lists(const std::vector<std::string>& lists,
                       const std::vector<SourceFile>& sources, const Shares& shares,
                       std::vector<DatasetEntry>& entries);

}  // namespace mocaplm
