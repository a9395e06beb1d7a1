// How large a file's figure is: what its lengths count, and how its path is brought to SMPL's legs.
#pragma once

#include <string>
#include <vector>

#include "motion/formats/remark.h"
#include "motion/formats/retarget.h"
#include "motion/formats/retarget_map.h"

namespace mocaplm {

struct FigureSize {
  double unit = 0;  // metres per unit of the file
  double path = 1;  // the root's path is multiplied by it
  std::vector<Remark> remarks;
};

// `leg` (hip to ankle along the bones) and `height` in the file's units. The unit is the option's,
// else the map's, else the usual one with which a person has a person's size, else the one that
// makes the figure 1.70 m tall. The path is scaled by SMPL's legs over the source's, so that feet
// that stand keep standing, unless `options.keep_path`. Throws DataError for a figure without a
// size, or one that with a given unit is no person's (0.3 to 5 m).
FigureSize find_size(double leg, double height, const RetargetMap& map, const BvhOptions& options,
                     const std::string& file);

}  // namespace mocaplm
