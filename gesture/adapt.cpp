#include "gesture/adapt.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

// x of least length with a x = b. Throws nothing; what cannot be met is left over.
Eigen::VectorXd least(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-11);
  return svd.solve(b);
}

// (M, number of conditions that may move): how P moves with them. The start stays where it is.
Eigen::MatrixXd free_directions(const PhaseModel& model, Eigen::Index v) {
  const std::vector<bool> free = model.q_is_free();
  const Eigen::MatrixXd plane = model.plane(v);
  Eigen::MatrixXd directions(plane.rows(), 0);
  for (std::size_t j = 0; j < free.size(); ++j) {
    if (!free[j]) continue;
    directions.conservativeResize(Eigen::NoChange, directions.cols() + 1);
    directions.rightCols(1) = plane.col(static_cast<Eigen::Index>(j));
  }
  directions.row(0).setZero();
  return directions;
}

Eigen::VectorXd end_velocity_change(const PhaseModel& model, Eigen::Index v, double change,
                                    EndVelocity kind) {
  const Eigen::VectorXd slope = Basis(model.harmonics).derivative(1);
  if (kind == EndVelocity::free) return slope * (change / slope.squaredNorm());
  Eigen::MatrixXd directions = free_directions(model, v);
  if (kind == EndVelocity::closest && directions.cols() > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(directions);
    directions = qr.householderQ() * Eigen::MatrixXd::Identity(directions.rows(), qr.rank());
  }
  const Eigen::RowVectorXd reach = slope.transpose() * directions;
  const double size = directions.norm() * slope.norm();
  if (!(reach.norm() > 1e-9 * size))
    throw UsageError("phase \"" + model.name + "\": the end velocity of \"" +
                     model.coordinates[static_cast<std::size_t>(v)] +
                     "\" does not depend on the conditions " + join(model.conditions, ", ") +
                     ", so the hyperplane cannot meet it");
  return directions * (reach.transpose() * (change / reach.squaredNorm()));
}

}  // namespace

Eigen::MatrixXd with_end_velocity(const PhaseModel& model, const Eigen::MatrixXd& p,
                                  const std::vector<std::optional<double>>& velocity,
                                  double duration, EndVelocity kind) {
  if (static_cast<Eigen::Index>(velocity.size()) != model.dimensions())
    throw UsageError("an end velocity needs " + std::to_string(model.dimensions()) +
                     " values, one for each of " + join(model.coordinates, ", "));
  const Eigen::VectorXd slope = Basis(model.harmonics).derivative(1);
  Eigen::MatrixXd out = p;
  for (Eigen::Index v = 0; v < model.dimensions(); ++v) {
    const auto& wanted = velocity[static_cast<std::size_t>(v)];
    if (!wanted) continue;
    // The basis knows normalised time only: velocities are multiplied by T.
    const double change = *wanted * duration - slope.dot(p.col(v));
    out.col(v) += end_velocity_change(model, v, change, kind);
  }
  return out;
}

Eigen::MatrixXd corrected(const PhaseModel& model, const Eigen::MatrixXd& p, double tau,
                          const Eigen::VectorXd& state, const Eigen::VectorXd& target,
                          Correction kind) {
  if (!(tau >= 0 && tau <= 1 - 1e-6))
    throw UsageError("a movement can be corrected at a normalised time from 0 to below 1, not at " +
                     format_number(tau));
  const Basis basis(model.harmonics);
  const Eigen::VectorXd now = basis.at(tau), last = basis.at(1);
  Eigen::MatrixXd constraints(kind == Correction::smooth ? 3 : 2, basis.size());
  constraints.row(0) = now.transpose();
  constraints.row(1) = last.transpose();
  if (kind == Correction::smooth) constraints.row(2) = basis.derivative(tau).transpose();
  Eigen::MatrixXd out = p;
  for (Eigen::Index v = 0; v < model.dimensions(); ++v) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(constraints.rows());
    change(0) = state(v) - now.dot(p.col(v));
    change(1) = target(v) - last.dot(p.col(v));
    if (kind != Correction::hyperplane) {
      out.col(v) += least(constraints, change);
      continue;
    }
    // All conditions may move, the start too; the whole movement may be elsewhere where the
    // conditions do not say where it is.
    Eigen::MatrixXd directions(basis.size(), model.n_conditions() + 1);
    directions << model.plane(v).leftCols(model.n_conditions()),
        Eigen::VectorXd::Unit(basis.size(), 0);
    for (const std::string& condition : model.conditions)
      if (condition == "start") directions.rightCols(1).setZero();
    const Eigen::MatrixXd reach = constraints * directions;
    const Eigen::VectorXd moved = least(reach, change);
    if ((reach * moved - change).norm() > 1e-7 * change.norm())
      throw UsageError("phase \"" + model.name + "\": no movement of the hyperplane of \"" +
                       model.coordinates[static_cast<std::size_t>(v)] +
                       "\" passes through the state and reaches the target");
    out.col(v) += directions * moved;
  }
  return out;
}

}  // namespace mocaplm
