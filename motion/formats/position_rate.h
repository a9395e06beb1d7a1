// The frame rate that a column of times means.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/formats/formats.h"

namespace mocaplm {

// Of times in seconds, written with `decimals` digits behind the point: the roundest rate (60
// before 59.94 before 59.9401) that gives all of them as they were rounded. Nothing for fewer than
// two frames. Times that jitter by less than half a frame give their mean rate and a remark; throws
// DataError naming the frame where they do not rise evenly.
std::optional<double> rate_of_times(const std::vector<double>& times, int decimals,
                                    const std::string& file, std::vector<Remark>& remarks);

}  // namespace mocaplm
