#include "motion/floor.h"

#include <algorithm>
#include <vector>

#include "motion/skeleton.h"

namespace mocaplm {

double floor_height(const Clip& clip) {
  std::vector<double> lowest;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions joints = joint_positions(clip, t);
    lowest.push_back(std::min({joints(7, 1), joints(8, 1), joints(10, 1), joints(11, 1)}));
  }
  const auto at = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 50);
  std::nth_element(lowest.begin(), at, lowest.end());
  return *at;
}

void align_floor(Clip& clip, double above) {
  clip.trans.col(1).array() += above - floor_height(clip);
}

}  // namespace mocaplm
