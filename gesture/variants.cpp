#include "gesture/variants.h"

#include <algorithm>

#include "common/text.h"

namespace mocaplm {

std::vector<MovementVariant> end_velocity_variants(
    const PhaseModel& model, const Eigen::MatrixXd& p,
    const std::vector<std::optional<double>>& velocity, double duration) {
  std::vector<MovementVariant> all = {{"planned", p, 0}};
  const auto add = [&](const char* name, EndVelocity kind) {
    all.push_back({name, with_end_velocity(model, p, velocity, duration, kind), 0});
  };
  add("hyperplane", EndVelocity::hyperplane);
  add("closest", EndVelocity::closest);
  add("free", EndVelocity::free);
  return all;
}

std::vector<MovementVariant> correction_variants(const PhaseModel& model, const Eigen::MatrixXd& p,
                                                 double tau, const Eigen::VectorXd& state,
                                                 const Eigen::VectorXd& target) {
  std::vector<MovementVariant> all = {{"planned", p, 0}};
  const auto add = [&](const char* name, Correction kind) {
    all.push_back({name, corrected(model, p, tau, state, target, kind), tau});
  };
  add("minimum", Correction::minimum);
  add("smooth", Correction::smooth);
  add("hyperplane", Correction::hyperplane);
  return all;
}

Eigen::MatrixXd sampled(const MovementVariant& variant, Eigen::Index n) {
  const Basis basis(static_cast<int>(variant.p.rows()) - 2);
  Eigen::MatrixXd values(n, variant.p.cols());
  for (Eigen::Index i = 0; i < n; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(n - 1);
    const Eigen::VectorXd phi = basis.at(variant.from + (1 - variant.from) * share);
    values.row(i) = phi.transpose() * variant.p;
  }
  return values;
}

Table variant_table(const std::vector<MovementVariant>& variants, const PhaseModel& model,
                    double duration) {
  std::vector<std::string> columns = {"movement"};
  for (const std::string& name : model.coordinates) {
    columns.push_back("end " + name);
    columns.push_back("end v_" + name);
  }
  for (const char* name : {"change of P", "peak acceleration", "jump of speed"})
    columns.push_back(name);
  Table table("phase " + model.name + ", T = " + format_fixed(duration, 3) + " s", columns);
  table.digits(std::vector<int>(columns.size(), 3));
  const Basis basis(model.harmonics);
  for (const MovementVariant& variant : variants) {
    const Eigen::MatrixXd change = variant.p - variants[0].p;
    std::vector<Json> row = {variant.name};
    const Eigen::VectorXd end = variant.p.transpose() * basis.at(1);
    const Eigen::VectorXd speed = variant.p.transpose() * basis.derivative(1) / duration;
    for (Eigen::Index v = 0; v < model.dimensions(); ++v) {
      row.push_back(end(v));
      row.push_back(speed(v));
    }
    double peak = 0;
    for (int i = 0; i <= 400; ++i) {
      const double tau = variant.from + (1 - variant.from) * i / 400.0;
      peak = std::max(peak, (variant.p.transpose() * basis.second(tau)).norm());
    }
    row.push_back(change.norm());
    row.push_back(peak / (duration * duration));
    const double jump = (change.transpose() * basis.derivative(variant.from)).norm() / duration;
    row.push_back(variant.from > 0 ? Json(jump) : Json());
    table.row(row);
  }
  return table;
}

}  // namespace mocaplm
