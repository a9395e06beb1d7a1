#include "gesture/player.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace mocaplm {

GesturePlayer::GesturePlayer(const GestureModel& model) : model_(model) {
  assert(!model.phases.empty());
}

void GesturePlayer::begin(std::size_t phase, double time, const Boundary& boundary) {
  begin(phase, time, boundary, model_.phases.at(phase).coefficients(boundary));
}

void GesturePlayer::begin(std::size_t phase, double time, const Boundary& boundary,
                          const Eigen::MatrixXd& p) {
  phase_ = phase;
  began_ = time;
  boundary_ = boundary;
  p_ = p;
  watcher_.emplace(model_.phases.at(phase).rule, model_.config.min_seconds);
  watcher_->begin(time);
}

Boundary GesturePlayer::draw(std::size_t phase, const Eigen::VectorXd& start,
                             Random& random) const {
  const PhaseModel& model = model_.phases.at(phase);
  Boundary boundary = model.demonstrations[random.below(model.demonstrations.size())];
  const auto has = [&](const char* name) {
    return std::find(model.conditions.begin(), model.conditions.end(), name) !=
           model.conditions.end();
  };
  if (has("displacement") && !has("end")) *boundary.end += start - boundary.start;
  boundary.start = start;
  boundary.duration = random.uniform(model.shortest(), model.longest());
  return boundary;
}

Eigen::VectorXd GesturePlayer::position(double time) const {
  const Basis basis(model_.phases[phase_].harmonics);
  return p_.transpose() * basis.at(std::clamp(tau(time), 0.0, 1.0));
}

void GesturePlayer::correct(double time, const Eigen::VectorXd& state,
                            const Eigen::VectorXd& target, Correction kind) {
  p_ = corrected(model_.phases[phase_], p_, tau(time), state, target, kind);
  boundary_.end = target;
}

GesturePlayer::Step GesturePlayer::observe(const MotionState& state, const std::string& event,
                                           double grace) {
  if (watcher_->push(state, event)) return Step::rule;
  const bool waits = model_.phases[phase_].rule.kind == Rule::Kind::event;
  const double late = state.time - began_ - boundary_.duration;
  return late >= (waits ? grace : 0) - 1e-9 ? Step::time : Step::going;
}

std::optional<std::size_t> GesturePlayer::next() const {
  if (phase_ + 1 < model_.phases.size()) return phase_ + 1;
  return model_.config.cycle ? std::optional<std::size_t>(0) : std::nullopt;
}

PlayedMovement play_all(const GestureModel& model, double rate, int cycles, std::uint64_t seed) {
  Random random(seed);
  GesturePlayer player(model);
  MotionEstimator estimator(model.config.window);
  std::vector<double> times;
  std::vector<Eigen::VectorXd> values;
  PlayedMovement played;
  const auto& first = model.phases[0].demonstrations;
  Eigen::VectorXd at = first[random.below(first.size())].start;
  std::int64_t step = 0;
  const auto sample = [&](const std::string& phase) {
    times.push_back(static_cast<double>(step) / rate);
    values.push_back(at);
    played.phases.push_back(phase);
    return estimator.push(times.back(), at);
  };
  const std::size_t count = model.phases.size() * static_cast<std::size_t>(cycles);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t phase = i % model.phases.size();
    player.begin(phase, static_cast<double>(step) / rate, player.draw(phase, at, random));
    auto ended = GesturePlayer::Step::going;
    while (ended == GesturePlayer::Step::going) {
      at = player.position(static_cast<double>(step) / rate);
      ended = player.observe(sample(model.phases[phase].name), "");
      ++step;
    }
    played.ended.push_back(ended == GesturePlayer::Step::rule ? "rule" : "time");
  }
  played.time =
      Eigen::Map<const Eigen::VectorXd>(times.data(), static_cast<Eigen::Index>(times.size()));
  played.values.resize(played.time.size(), at.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    played.values.row(static_cast<Eigen::Index>(i)) = values[i].transpose();
  return played;
}

}  // namespace mocaplm
