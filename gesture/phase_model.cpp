#include "gesture/phase_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "numeric/distributions.h"

namespace mocaplm {

namespace {

Place of_phase(const Recordings& recordings, const std::string& phase) {
  return {recordings.source, "phase \"" + phase + "\""};
}

// Q of a boundary into `q` (k), which has the right size.
template <class Vector>
void fill_q(const std::vector<std::string>& conditions, const Boundary& boundary, Vector&& q) {
  Eigen::Index at = 0;
  std::size_t more = 0;
  for (const std::string& name : conditions) {
    if (name == "duration") {
      q(at++) = boundary.duration;
    } else if (!is_own_condition(name)) {
      q(at++) = boundary.more[more++];
    } else {
      for (Eigen::Index v = 0; v < boundary.start.size(); ++v)
        q(at++) = name == "start" ? boundary.start(v)
                  : name == "end" ? (*boundary.end)(v)
                                  : (*boundary.end)(v)-boundary.start(v);
    }
  }
}

Eigen::Index q_size(const std::vector<std::string>& conditions, Eigen::Index dimensions) {
  Eigen::Index size = 0;
  for (const std::string& name : conditions)
    size += is_own_condition(name) && name != "duration" ? dimensions : 1;
  return size;
}

bool needs_end(const std::vector<std::string>& conditions) {
  return std::any_of(conditions.begin(), conditions.end(), [](const std::string& name) {
    return name == "end" || name == "displacement";
  });
}

void check_moves(const PhaseDemonstrations& phase, const Recordings& recordings) {
  for (std::size_t v = 0; v < recordings.coordinates.size(); ++v) {
    const auto column = static_cast<Eigen::Index>(v);
    double low = phase.all[0].values(0, column), high = low;
    for (const Demonstration& one : phase.all) {
      low = std::min(low, one.values.col(column).minCoeff());
      high = std::max(high, one.values.col(column).maxCoeff());
    }
    if (high - low > 1e-9 * (std::abs(low) + std::abs(high))) continue;
    throw DataError(of_phase(recordings, phase.name),
                    "coordinate \"" + recordings.coordinates[v] + "\" is " + format_number(low) +
                        " in every sample of all demonstrations; leave it out with --coordinates");
  }
}

}  // namespace

double PhaseModel::shortest() const {
  double least = demonstrations.at(0).duration;
  for (const Boundary& one : demonstrations) least = std::min(least, one.duration);
  return least;
}

double PhaseModel::longest() const {
  double most = demonstrations.at(0).duration;
  for (const Boundary& one : demonstrations) most = std::max(most, one.duration);
  return most;
}

Eigen::VectorXd PhaseModel::q(const Boundary& boundary) const {
  const auto more = static_cast<std::size_t>(
      std::count_if(conditions.begin(), conditions.end(),
                    [](const std::string& condition) { return !is_own_condition(condition); }));
  const bool end_fits =
      boundary.end ? boundary.end->size() == dimensions() : !needs_end(conditions);
  if (boundary.start.size() != dimensions() || !end_fits || boundary.more.size() != more)
    throw UsageError("phase \"" + name + "\" needs a start and an end of " +
                     std::to_string(dimensions()) + " numbers (" + join(coordinates, ", ") +
                     ") and " + std::to_string(more) + " further conditions");
  if (!(boundary.duration > 0)) throw UsageError("a movement's duration must be above 0");
  Eigen::VectorXd q(n_conditions());
  fill_q(conditions, boundary, q);
  return q;
}

std::vector<std::string> PhaseModel::q_names() const {
  std::vector<std::string> names;
  for (const std::string& condition : conditions) {
    if (!is_own_condition(condition) || condition == "duration") {
      names.push_back(condition);
      continue;
    }
    for (const std::string& coordinate : coordinates) names.push_back(condition + "_" + coordinate);
  }
  return names;
}

std::vector<bool> PhaseModel::q_is_free() const {
  std::vector<bool> free;
  for (const std::string& condition : conditions) {
    const bool one = condition != "start" && condition != "duration";
    const bool wide = is_own_condition(condition) && condition != "duration";
    free.insert(free.end(), wide ? coordinates.size() : 1, one);
  }
  return free;
}

Eigen::MatrixXd PhaseModel::coefficients(const Boundary& boundary) const {
  const Eigen::VectorXd all = f.leftCols(n_conditions()) * q(boundary) + f.col(n_conditions());
  Eigen::MatrixXd p = Eigen::Map<const Eigen::MatrixXd>(all.data(), size(), dimensions());
  p.row(0) = boundary.start.transpose();
  if (boundary.end) p.row(1) = (*boundary.end - boundary.start).transpose();
  return p;
}

Eigen::MatrixXd PhaseModel::interval(const Boundary& boundary, Eigen::Index samples) const {
  Eigen::VectorXd known(n_conditions() + 1);
  known << q(boundary), 1;
  const double leverage = known.dot(gram_inverse * known);
  const double t = t_quantile(0.975, static_cast<double>(std::max<Eigen::Index>(1, dof)));
  const Eigen::MatrixXd phi = Basis(harmonics).table(samples);
  Eigen::MatrixXd half(samples, dimensions());
  for (Eigen::Index v = 0; v < dimensions(); ++v) {
    Eigen::MatrixXd spread = covariance.middleRows(v * size(), size());
    const Eigen::Index set = boundary.end ? 2 : 1;  // these are not regressed
    spread.topRows(set).setZero();
    spread.leftCols(set).setZero();
    const Eigen::ArrayXd variance = (phi * spread).cwiseProduct(phi).rowwise().sum().array();
    half.col(v) =
        t * (variance.max(0) * (1 + leverage) + truncation(v) * truncation(v)).sqrt().matrix();
  }
  return half;
}

PhaseData phase_data(const PhaseDemonstrations& phase, const Recordings& recordings,
                     const GestureConfig& config) {
  if (config.samples < config.harmonics + 2)
    throw UsageError(std::to_string(config.harmonics) + " harmonics need at least " +
                     std::to_string(config.harmonics + 2) + " samples, --samples is " +
                     std::to_string(config.samples));
  for (std::size_t i = 0; i < config.conditions.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (config.conditions[i] == config.conditions[j])
        throw UsageError("the condition \"" + config.conditions[i] + "\" is given twice");
  check_moves(phase, recordings);
  const Expansion expansion(static_cast<int>(config.harmonics), config.samples);
  const auto n = static_cast<Eigen::Index>(phase.all.size());
  const auto dimensions = static_cast<Eigen::Index>(recordings.coordinates.size());
  const Eigen::Index m = expansion.basis().size();
  PhaseData data;
  data.q.resize(n, q_size(config.conditions, dimensions));
  data.p.resize(n, dimensions * m);
  data.truncation = Eigen::VectorXd::Zero(dimensions);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Demonstration& one = phase.all[static_cast<std::size_t>(i)];
    data.boundaries.push_back({one.start(),
                               one.end(),
                               one.duration(),
                               {one.more.data(), one.more.data() + one.more.size()}});
    fill_q(config.conditions, data.boundaries.back(), data.q.row(i));
    data.movements.push_back(resample(one.time, one.values, config.samples));
    const Eigen::MatrixXd p = expansion.coefficients(data.movements.back());
    for (Eigen::Index v = 0; v < dimensions; ++v)
      data.p.row(i).segment(v * m, m) = p.col(v).transpose();
    data.truncation += (data.movements.back() - expansion.values(p))
                           .array()
                           .square()
                           .colwise()
                           .mean()
                           .matrix()
                           .transpose() /
                       static_cast<double>(n);
  }
  data.truncation = data.truncation.cwiseSqrt();
  return data;
}

PhaseModel fit_phase(const PhaseDemonstrations& phase, const Recordings& recordings,
                     const GestureConfig& config, const PhaseData& data) {
  const Eigen::Index n = data.q.rows(), unknowns = data.q.cols() + 1;
  if (n < unknowns + 2)
    throw DataError(of_phase(recordings, phase.name),
                    "has " + std::to_string(n) + (n == 1 ? " demonstration" : " demonstrations") +
                        ", but " + std::to_string(unknowns - 1) + " conditions (" +
                        join(config.conditions, ", ") + " of " +
                        std::to_string(recordings.coordinates.size()) +
                        " coordinates) need at least " + std::to_string(unknowns + 2) +
                        "; give more demonstrations or fewer --conditions");
  const LinearRegression fit = fit_linear(data.q, data.p, config.regression());
  PhaseModel model;
  model.name = phase.name;
  model.rule = phase.rule;
  model.coordinates = recordings.coordinates;
  model.conditions = config.conditions;
  model.harmonics = static_cast<int>(config.harmonics);
  model.f = fit.f;
  model.gram_inverse = fit.gram_inverse;
  model.dof = fit.dof();
  model.rank = fit.rank;
  model.truncation = data.truncation;
  model.demonstrations = data.boundaries;
  for (const Demonstration& one : phase.all) model.demonstration_names.push_back(one.name);
  const Eigen::MatrixXd spread = fit.covariance();
  const Eigen::Index m = model.size();
  model.covariance.resize(data.p.cols(), m);
  for (Eigen::Index v = 0; v < model.dimensions(); ++v)
    model.covariance.middleRows(v * m, m) = spread.block(v * m, v * m, m, m);
  return model;
}

MovementWriter::MovementWriter(const PhaseModel& model, Eigen::Index samples)
    : model_(model),
      table_(Basis(model.harmonics).table(samples)),
      q_(Eigen::VectorXd::Ones(model.n_conditions() + 1)),
      p_(model.f.rows()) {}

void MovementWriter::write(const Boundary& boundary, Eigen::MatrixXd& values) {
  assert(values.rows() == table_.rows() && values.cols() == model_.dimensions());
  fill_q(model_.conditions, boundary, q_);
  p_.noalias() = model_.f * q_;
  const Eigen::Index m = model_.size();
  Eigen::Map<Eigen::MatrixXd> p(p_.data(), m, model_.dimensions());
  for (Eigen::Index v = 0; v < model_.dimensions(); ++v) {
    p(0, v) = boundary.start(v);
    if (boundary.end) p(1, v) = (*boundary.end)(v)-boundary.start(v);
  }
  values.noalias() = table_ * p;
}

}  // namespace mocaplm
