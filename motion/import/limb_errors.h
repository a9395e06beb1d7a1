// How well the limbs of retargeted BVH files point where the source's did, over a whole import.
#pragma once

#include <map>
#include <string>

#include "common/table.h"
#include "motion/formats/retarget.h"

namespace mocaplm {

class LimbErrors {
 public:
  void add(const std::string& clip, Eigen::Index frames, const RetargetReport& report);
  bool empty() const { return limbs_.empty(); }
  // Mean over all limbs and frames, degrees.
  double mean_degrees() const;
  // One row a limb: mean and largest angle, and where the largest is.
  Table table() const;

 private:
  struct Limb {
    double sum = 0, max = -1;
    Eigen::Index frames = 0, worst_frame = 0;
    std::string worst_clip;
  };
  std::map<std::string, Limb> limbs_;
  std::map<std::string, int> schemes_;
};

}  // namespace mocaplm
