// Long dances of models beside the clips that they begin from: do they stay bounded and alive?
#pragma once

#include <vector>

#include "common/table.h"
#include "evaluate/generated/asked_models.h"

namespace mocaplm {

struct LongOptions : GeneratedOptions {
  double seconds = 60;      // of each dance, after what is shown
  std::int64_t dances = 8;  // from clips evenly drawn from the split
};

// For each model a table of measures (the data, the data as its tokens tell it, the dances' mean
// and the least and most of any dance) and one that tells them over time. Throws DataError when no
// clip is long enough to be shown, and for unsound models.
std::vector<Table> long_tables(const LongOptions& options);

}  // namespace mocaplm
