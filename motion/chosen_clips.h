// Which clips of a dataset a command looks at: those of a split that have the labels asked for
// (--where label=value). Names that the dataset does not have are refused the same way everywhere.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "motion/dataset.h"

namespace mocaplm {

// Throws UsageError when no clip has the label: `asker` ("--by", what it was asked with), the
// dataset, the nearest label that it has and all of them.
void check_label(const Dataset& dataset, const std::string& label, const std::string& asker);
// The same for a value of a label that the dataset has.
void check_label_value(const Dataset& dataset, const std::string& label, const std::string& value,
                       const std::string& asker);

// "content=walk" as {"content", "walk"}; the value may hold more of "=". Throws UsageError, which
// speaks of --where, when the text is not of that form.
std::pair<std::string, std::string> parse_where(const std::string& text);

// The entries whose labels are as all of `where` ("content=walk") and whose split is `split` ("":
// any), in the dataset's order. Throws UsageError as parse_where, check_label and check_label_value
// do, DataError when no entry is left.
std::vector<DatasetEntry> chosen_entries(const Dataset& dataset, const std::string& split,
                                         const std::vector<std::string>& where);

}  // namespace mocaplm
