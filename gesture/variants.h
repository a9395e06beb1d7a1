// The ways to change a movement, side by side: what `mocaplm gesture play` compares (figure 4).
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "gesture/adapt.h"

namespace mocaplm {

struct MovementVariant {
  std::string name;
  Eigen::MatrixXd p;  // (M, V)
  double from = 0;    // the normalised time that it holds from
};

// The movement as planned, then by each EndVelocity: "hyperplane", "closest", "free".
std::vector<MovementVariant> end_velocity_variants(
    const PhaseModel& model, const Eigen::MatrixXd& p,
    const std::vector<std::optional<double>>& velocity, double duration);
// As planned, then by each Correction: "minimum", "smooth", "hyperplane".
std::vector<MovementVariant> correction_variants(const PhaseModel& model, const Eigen::MatrixXd& p,
                                                 double tau, const Eigen::VectorXd& state,
                                                 const Eigen::VectorXd& target);

// (n, V): n times from variant.from * T to T.
Eigen::MatrixXd sampled(const MovementVariant& variant, Eigen::Index n);

// Ends, speeds at the ends, how far P is from the first variant's, the largest acceleration from
// variant.from on and the jump of the speed there.
Table variant_table(const std::vector<MovementVariant>& variants, const PhaseModel& model,
                    double duration);

}  // namespace mocaplm
