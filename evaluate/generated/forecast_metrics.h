// How far a forecast of motion is from what happened, in the protocol of Aksan, Kaufmann and
// Hilliges, "Structured prediction helps 3D human motion modelling" (ICCV 2019), and Aksan et al.,
// "A spatio-temporal transformer for 3D human motion prediction" (3DV 2021), as their published
// evaluation code computes it: the metrics of the thesis's Table 4.7.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

// The protocol: 60 frames a second, 2 s seen, windows of 3 s, forecasts told at 100 to 400 ms.
constexpr double kForecastFps = 60, kForecastSeedSeconds = 2;
const std::vector<double>& forecast_horizons();  // milliseconds

// Its 15 joints: all but the root, feet and hands (SMPL 1-6, 9, 12-19).
const std::vector<int>& forecast_joints();

// Its radii of PCK, in lengths of the left thigh, ascending.
const std::vector<double>& pck_thresholds();

// Errors of one forecast, frame by frame (T).
struct ForecastErrors {
  // L2 norm of the differences of all local Euler angles, radians.
  Eigen::VectorXd euler;
  // Angle of the rotation between forecast and truth, global (the root's rotation left out), mean
  // over the joints, radians.
  Eigen::VectorXd joint_angle;
  // Distance between positions, mean over the joints, in lengths of the left thigh.
  Eigen::VectorXd positional;
  // (T, thresholds) share of the joints within each radius of PCK.
  Eigen::MatrixXd correct;
};

// Up to a horizon: the first three are sums over the frames, the last is the area under the curve
// of PCK (each point a mean over the frames) over its radii, divided by their span.
struct ForecastScore {
  double euler = 0, joint_angle = 0, positional = 0, auc = 0;
};

class ForecastMetrics {
 public:
  // The joints that count, in SMPL's numbering. All others, and the root, are taken as unmoved in
  // forecast and truth. Euler components that never change in `targets` (standard deviation of at
  // most 1e-4 over all frames) are left out, as in the protocol, which looks at a batch.
  ForecastMetrics(std::vector<int> joints, const std::vector<Clip>& targets);

  // Both with the same number of frames.
  ForecastErrors errors(const Clip& forecast, const Clip& target) const;

  const std::vector<int>& joints() const { return joints_; }

 private:
  std::vector<int> joints_;
  std::vector<bool> moves_;  // per joint and axis
};

// Frames [0, frames) of the errors; frames lie in 1 .. T. `milliseconds` is the horizon that they
// stand for: AUC looks at the 6 smallest radii before 100 ms, 7 before 200, 8 before 300, then all,
// since the larger ones would be reached anyway.
ForecastScore score_until(const ForecastErrors& errors, Eigen::Index frames, double milliseconds);

}  // namespace mocaplm
