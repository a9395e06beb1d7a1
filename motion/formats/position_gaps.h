// Places that a file of positions leaves out for a while.
#pragma once

#include <string>
#include <vector>

#include "motion/formats/formats.h"
#include "motion/ik/points.h"

namespace mocaplm {

// Makes every given point finite in every frame. Gaps of up to a second are interpolated when
// `fill` (at the clip's ends the nearest place is kept) and said in `remarks`. Points that nobody
// needs (needed_points) and that are missing for longer are left out, said too. Throws DataError
// naming frame and joint for every other gap.
void close_gaps(PointTracks& tracks, bool fill, const std::string& file,
                std::vector<Remark>& remarks);

}  // namespace mocaplm
