// Changing a movement: a speed asked for at its end (equation 9), and replanning on the way
// (equation 10) of Lippi, Avizzano and Ruffaldi 2012. P is (M, V), one column a coordinate; each
// coordinate is treated by itself, as in the paper.
#pragma once

#include <optional>
#include <vector>

#include "gesture/phase_model.h"

namespace mocaplm {

// Where the corrected P is looked for.
enum class EndVelocity {
  // Equation 9: on the coordinate's regressed hyperplane, moving the conditions least:
  // dP = F dQ, dQ = [dPhi(1)' F]^+ (v - v_free).
  hyperplane,
  // On the hyperplane, moving P least: what the text below equation 9 promises.
  closest,
  // Anywhere, moving P least: figure 4's comparison.
  free
};
// `velocity` (V): coordinates without a value keep theirs; units of the coordinate per second. The
// start stays. On the hyperplane only those conditions move that are neither start nor duration,
// and not the 1. Throws UsageError when the hyperplane has no movement with that speed.
Eigen::MatrixXd with_end_velocity(const PhaseModel& model, const Eigen::MatrixXd& p,
                                  const std::vector<std::optional<double>>& velocity,
                                  double duration, EndVelocity kind);

enum class Correction {
  // Equation 10: dP = [dY(tau) dY_f] [Phi(tau) Phi(1)]^+, moving P least.
  minimum,
  // The same with the speed at tau kept: no jump of the velocity.
  smooth,
  // On the hyperplane, moving the conditions least: the movement of another start and end that
  // passes through the state at tau. This is what the paper says equation 10 does.
  hyperplane
};
// The movement is at `state` (V) at normalised time tau in [0, 1), and shall end at `target` (V).
// What was done before tau is history: only the returned P's part after tau is for use. Throws
// UsageError when tau is so near to 1 that nothing can be changed, and when the hyperplane has no
// such movement.
Eigen::MatrixXd corrected(const PhaseModel& model, const Eigen::MatrixXd& p, double tau,
                          const Eigen::VectorXd& state, const Eigen::VectorXd& target,
                          Correction kind);

}  // namespace mocaplm
