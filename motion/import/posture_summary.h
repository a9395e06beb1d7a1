// How the figures of a whole import stand: of each measure the mean and where its extremes are.
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "motion/posture.h"

namespace mocaplm {

// Frames of a clip that show how it stands, at most.
inline constexpr Eigen::Index kPostureFrames = 40;

class PostureSummary {
 public:
  // In the order of the clips, whatever thread read them.
  void add(const std::string& clip, const BodyPosture& posture, const RetargetReport& report);
  bool empty() const { return clips_.empty(); }
  // One row a measure: mean, smallest and largest, each with its clip; those that no clip has are
  // left out. Of several clips the first.
  Table table() const;

 private:
  struct Row {
    std::string clip;
    BodyPosture posture;
    double unit = 0, size = 0;  // of the skeleton that was matched; 0: none was
  };
  std::vector<Row> clips_;
};

}  // namespace mocaplm
