// Which clips of a dataset an evaluation looks at, and what it tells a model of them.
#pragma once

#include <string>
#include <vector>

#include "motion/dataset.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

// The entries of a split that have all of `where` ("label=value"). Throws UsageError when one of
// these is not of that form, DataError when no clip is left.
std::vector<DatasetEntry> chosen_entries(const Dataset& dataset, const std::string& split,
                                         const std::vector<std::string>& where);

// Those of a clip's labels that a model has learned as conditions and whose value it knows.
Labels known_conditions(const Labels& labels, const std::vector<std::string>& conditions,
                        const Tokenizer& tokenizer);

}  // namespace mocaplm
