// Cuts recordings into the demonstrations of each phase.
#pragma once

#include "gesture/config.h"
#include "gesture/recording.h"
#include "gesture/rule.h"

namespace mocaplm {

struct PhaseDemonstrations {
  std::string name;
  Rule rule;
  std::vector<Demonstration> all;
};

struct Cut {
  std::vector<PhaseDemonstrations> phases;  // in their order
  std::size_t unfinished = 0;               // pieces at a recording's end whose phase did not end
};

// By config.phases, or where those are none by the recordings' own column, or as one phase
// "movement" that ends with its time. A phase begins at the sample where the one before it ends.
// With config.cycle a recording goes through the phases again and again, otherwise once; what comes
// after the last phase is not used. Throws DataError for a piece of fewer than 4 samples and a
// phase without any demonstration, UsageError for rules that cannot be read and for leave_out's
// names that no phase has.
Cut cut_recordings(const Recordings& recordings, const GestureConfig& config);

}  // namespace mocaplm
