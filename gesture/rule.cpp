#include "gesture/rule.h"

#include <Eigen/LU>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> all;
  for (std::string word; stream >> word;) all.push_back(word);
  return all;
}

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw UsageError("rule \"" + text + "\": " + why +
                   "; a rule is one of: SIGNAL < NUMBER, SIGNAL > NUMBER, near x=1 y=2 by 0.1, "
                   "speed minimum, event NAME");
}

double number(const std::string& rule, const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value))
    refuse(rule, "expected a number, found \"" + text + "\"");
  return value;
}

Eigen::Index coordinate(const std::vector<std::string>& coordinates, const std::string& name) {
  const auto found = std::find(coordinates.begin(), coordinates.end(), name);
  return found == coordinates.end() ? -1 : found - coordinates.begin();
}

void parse_signal(Rule& rule, const std::string& name,
                  const std::vector<std::string>& coordinates) {
  using Signal = Rule::Signal;
  rule.coordinate = coordinate(coordinates, name);
  if (rule.coordinate >= 0) return;
  if (name == "speed" || name == "acceleration") {
    rule.signal = name == "speed" ? Signal::speed : Signal::total_acceleration;
    return;
  }
  if (name.rfind("v_", 0) == 0 || name.rfind("a_", 0) == 0)
    rule.coordinate = coordinate(coordinates, name.substr(2));
  if (rule.coordinate < 0)
    refuse(rule.text, "there is no \"" + name + "\" (coordinates: " + join(coordinates, ", ") +
                          "; v_ and a_ before them, speed, acceleration)");
  rule.signal = name[0] == 'v' ? Signal::velocity : Signal::acceleration;
}

void parse_near(Rule& rule, const std::vector<std::string>& parts,
                const std::vector<std::string>& coordinates) {
  if (parts.size() < 4 || parts[parts.size() - 2] != "by")
    refuse(rule.text, "\"near\" needs coordinates and \"by DISTANCE\"");
  rule.kind = Rule::Kind::near;
  rule.value = number(rule.text, parts.back());
  if (!(rule.value > 0)) refuse(rule.text, "the distance must be above 0");
  for (std::size_t i = 1; i + 2 < parts.size(); ++i) {
    const std::vector<std::string> sides = split(parts[i], '=');
    const Eigen::Index index = coordinate(coordinates, sides[0]);
    if (sides.size() != 2 || index < 0)
      refuse(rule.text, "expected COORDINATE=NUMBER, found \"" + parts[i] +
                            "\" (coordinates: " + join(coordinates, ", ") + ")");
    rule.point.emplace_back(index, number(rule.text, sides[1]));
  }
}

}  // namespace

Rule parse_rule(const std::string& text, const std::vector<std::string>& coordinates) {
  const std::vector<std::string> parts = words(text);
  Rule rule;
  rule.text = join(parts, " ");
  if (parts.empty()) return rule;
  if (parts[0] == "near") {
    parse_near(rule, parts, coordinates);
  } else if (parts[0] == "event" && parts.size() == 2) {
    rule.kind = Rule::Kind::event;
    rule.event = parts[1];
  } else if (parts.size() > 1 && parts[0] == "speed" && parts[1] == "minimum") {
    rule.kind = Rule::Kind::speed_minimum;
    rule.value = parts.size() > 2 ? number(rule.text, parts[2]) : 0.5;
    if (parts.size() > 3 || !(rule.value > 0 && rule.value < 1))
      refuse(rule.text, "after \"speed minimum\" a share between 0 and 1 may stand");
  } else if (parts.size() == 3 && (parts[1] == "<" || parts[1] == ">")) {
    rule.kind = Rule::Kind::compare;
    rule.below = parts[1] == "<";
    rule.value = number(rule.text, parts[2]);
    parse_signal(rule, parts[0], coordinates);
  } else {
    refuse(rule.text, "it cannot be read");
  }
  return rule;
}

std::vector<PhaseRule> parse_phases(const std::vector<std::string>& texts,
                                    const std::vector<std::string>& coordinates) {
  std::vector<PhaseRule> phases;
  for (const std::string& text : texts) {
    const std::size_t colon = text.find(':');
    const std::vector<std::string> name = words(text.substr(0, colon));
    if (name.empty()) throw UsageError("phase \"" + text + "\" has no name, expected NAME: RULE");
    PhaseRule phase{join(name, " "), {}};
    for (const PhaseRule& other : phases)
      if (other.name == phase.name)
        throw UsageError("two phases have the name \"" + phase.name + "\"");
    if (colon != std::string::npos) phase.rule = parse_rule(text.substr(colon + 1), coordinates);
    phases.push_back(phase);
  }
  return phases;
}

MotionState MotionEstimator::push(double time, const Eigen::VectorXd& position) {
  past_.emplace_back(time, position);
  while (past_.size() > 4 && past_.front().first < time - window_) past_.pop_front();
  MotionState state{time, position, Eigen::VectorXd::Zero(position.size()),
                    Eigen::VectorXd::Zero(position.size())};
  if (past_.size() < 3) return state;
  // In units of the time looked at, so that the normal equations are well conditioned.
  const double unit = time - past_.front().first;
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(3, position.size());
  for (const auto& [when, where] : past_) {
    const double s = (when - time) / unit;
    const Eigen::Vector3d row(1, s, s * s);
    gram += row * row.transpose();
    right += row * (where - position).transpose();
  }
  const Eigen::MatrixXd parabola = gram.inverse() * right;
  state.velocity = parabola.row(1).transpose() / unit;
  state.acceleration = 2 * parabola.row(2).transpose() / (unit * unit);
  return state;
}

void RuleWatcher::begin(double time) {
  began_ = time;
  peak_ = lowest_ = 0;
  since_lowest_ = 0;
}

bool RuleWatcher::holds(const MotionState& state, const std::string& event) const {
  if (rule_.kind == Rule::Kind::event) return event == rule_.event;
  if (rule_.kind == Rule::Kind::near) {
    double square = 0;
    for (const auto& [index, value] : rule_.point)
      square += std::pow(state.position(index) - value, 2);
    return square < rule_.value * rule_.value;
  }
  if (rule_.kind != Rule::Kind::compare) return false;
  double value = 0;
  switch (rule_.signal) {
    case Rule::Signal::position:
      value = state.position(rule_.coordinate);
      break;
    case Rule::Signal::velocity:
      value = state.velocity(rule_.coordinate);
      break;
    case Rule::Signal::acceleration:
      value = state.acceleration(rule_.coordinate);
      break;
    case Rule::Signal::speed:
      value = state.velocity.norm();
      break;
    case Rule::Signal::total_acceleration:
      value = state.acceleration.norm();
      break;
  }
  return rule_.below ? value < rule_.value : value > rule_.value;
}

std::optional<std::size_t> RuleWatcher::push_speed(const MotionState& state) {
  const double speed = state.velocity.norm();
  ++since_lowest_;
  if (speed > peak_ && lowest_ >= rule_.value * peak_) peak_ = lowest_ = speed;
  if (speed <= lowest_) {
    lowest_ = speed;
    since_lowest_ = 0;
  }
  const bool low = lowest_ < rule_.value * peak_;
  // A rise by a tenth of the peak is more than the noise of the speed.
  if (low && speed > lowest_ + 0.1 * peak_) return since_lowest_;
  return std::nullopt;
}

std::optional<std::size_t> RuleWatcher::push(const MotionState& state, const std::string& event) {
  std::optional<std::size_t> ended;
  if (rule_.kind == Rule::Kind::speed_minimum)
    ended = push_speed(state);
  else if (holds(state, event))
    ended = 0;
  if (state.time - began_ < min_seconds_) return std::nullopt;
  return ended;
}

std::optional<std::size_t> RuleWatcher::finish() const {
  if (rule_.kind == Rule::Kind::speed_minimum && lowest_ < rule_.value * peak_)
    return since_lowest_;
  if (rule_.kind == Rule::Kind::time) return 0;
  return std::nullopt;
}

}  // namespace mocaplm
