#include "gesture/juggling/demonstrator.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/text.h"
#include "gesture/juggling/ball_world.h"

namespace mocaplm {

namespace {

using Eigen::Vector2d;
using State = QuinticPath::State;

const Vector2d kHome(0.20, 0.0), kTop(0.09, 0.36), kBottom(-0.05, -0.28);
constexpr double kBottomLine = -0.25;  // going down is over below it
constexpr double kHomeRadius = 0.04;

enum class Phase { toss, down, catching, back };

class User {
 public:
  explicit User(const JuggleConfig& config)
      : config_(config), random_(static_cast<std::uint64_t>(config.seed)), world_(config) {
    state_ = {scattered(kHome, 0.008), Vector2d::Zero(), Vector2d::Zero()};
    start_recording();
    go(Phase::toss);
  }

  Recordings show() {
    std::int64_t done = 0, tried = 0;
    while (done < config_.demonstrations) {
      const std::string event = sample();
      if (event == "drop") {
        if (++tried >= 10)
          throw UsageError(
              "the user of this task drops ten balls in a row: its settings "
              "(gravity, toss_threshold, noise) make it impossible");
        restart();
        continue;
      }
      if (event == "catch") tried = 0;
      done += advance(event);
    }
    finish_recording();
    Recordings all;
    all.source = "made-up user of the juggling task";
    all.coordinates = {"x", "y"};
    all.all = std::move(recordings_);
    return all;
  }

 private:
  Vector2d scattered(const Vector2d& place, double deviation) {
    const double x = random_.normal(), y = random_.normal();
    return place + deviation * Vector2d(x, y);
  }

  void go(Phase phase) {
    phase_ = phase;
    began_ = world_.time();
    State to{Vector2d::Zero(), Vector2d::Zero(), Vector2d::Zero()};
    double seconds = 0;
    switch (phase) {
      case Phase::toss:
        to.position = scattered(kTop, 0.012);
        seconds = 0.46 + 0.015 * random_.normal();
        break;
      case Phase::down:
        to.position = scattered(kBottom, 0.008);
        seconds = 0.42 + 0.02 * random_.normal();
        break;
      case Phase::catching:
        // To where the ball will be, and a little along with it.
        seconds = 0.40 + 0.03 * random_.normal();
        to.position = scattered(world_.ball_in(seconds), 0.008);
        to.velocity = 0.25 * world_.ball_velocity();
        break;
      case Phase::back:
        to.position = scattered(kHome, 0.008);
        seconds = 0.5 + 0.03 * random_.normal();
        break;
    }
    path_ = QuinticPath(state_, to, std::max(0.2, seconds));
    for (Vector2d& one : deviations_) one = scattered(Vector2d::Zero(), 0.003);
  }

  // The hand at `t` of its path, with a deviation that begins and ends without speed.
  State hand(double t) const {
    State state = path_.at(t);
    const double tau = std::clamp(t / path_.seconds(), 0.0, 1.0), rate = kPi / path_.seconds();
    const double s = std::sin(kPi * tau), c = std::cos(kPi * tau);
    // a sin^2 + b sin(pi tau) sin(2 pi tau) = (a + 2 b cos) sin^2
    state.position += (deviations_[0] + 2 * c * deviations_[1]) * s * s;
    state.velocity += rate * (2 * s * c * (deviations_[0] + 2 * c * deviations_[1]) -
                              2 * s * s * s * deviations_[1]);
    return state;
  }

  std::string sample() {
    state_ = hand(world_.time() + 1 / config_.rate - began_);
    const Vector2d seen = scattered(state_.position, config_.sensor_noise);
    const std::string event =
        world_.step(seen, phase_ == Phase::toss && world_.time() - began_ > kHandMinSeconds,
                    phase_ == Phase::catching);
    times_.push_back(world_.time() - recording_began_);
    places_.push_back(seen);
    events_.push_back(event == "drop" ? "" : event);
    return event;
  }

  // Goes on with the next phase where this one is done; 1 when a cycle is complete.
  int advance(const std::string& event) {
    const bool over = world_.time() - began_ >= path_.seconds() - 1e-9;
    if (phase_ == Phase::catching && event == "catch") {
      go(Phase::back);
    } else if (over && phase_ == Phase::toss) {
      if (world_.held())
        throw UsageError("the ball does not leave the user's hand: lower toss_threshold, it is " +
                         format_number(config_.toss_threshold) + " m/s2");
      go(Phase::down);
    } else if (over && phase_ == Phase::down) {
      go(Phase::catching);
    } else if (over && phase_ == Phase::back) {
      go(Phase::toss);
      return 1;
    }
    return 0;
  }

  void start_recording() {
    times_.clear();
    places_.clear();
    events_.clear();
    recording_began_ = world_.time();
  }

  void finish_recording() {
    Recording one;
    const std::size_t number = recordings_.size() + 1;
    one.name = "user" + (number > 1 ? " " + std::to_string(number) : "");
    one.time =
        Eigen::Map<const Eigen::VectorXd>(times_.data(), static_cast<Eigen::Index>(times_.size()));
    one.values.resize(one.time.size(), 2);
    for (std::size_t i = 0; i < places_.size(); ++i)
      one.values.row(static_cast<Eigen::Index>(i)) = places_[i].transpose();
    one.more.resize(one.time.size(), 0);
    one.events = events_;
    recordings_.push_back(one);
  }

  // Takes a new ball at home. What was recorded up to the cycle before stays.
  void restart() {
    finish_recording();
    world_ = BallWorld(config_);
    state_ = {scattered(kHome, 0.008), Vector2d::Zero(), Vector2d::Zero()};
    start_recording();
    go(Phase::toss);
  }

  const JuggleConfig& config_;
  Random random_;
  BallWorld world_;
  Phase phase_ = Phase::toss;
  State state_;
  QuinticPath path_;
  Vector2d deviations_[2] = {Vector2d::Zero(), Vector2d::Zero()};
  double began_ = 0, recording_began_ = 0;
  std::vector<double> times_;
  std::vector<Vector2d> places_;
  std::vector<std::string> events_;
  std::vector<Recording> recordings_;
};

}  // namespace

QuinticPath::QuinticPath(const State& from, const State& to, double seconds) : seconds_(seconds) {
  // Position, velocity and acceleration of sum c_k t^k at 0 and at `seconds`.
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
  for (int k = 0; k < 6; ++k) {
    a(0, k) = k == 0;
    a(1, k) = k == 1;
    a(2, k) = k == 2 ? 2 : 0;
    a(3, k) = std::pow(seconds, k);
    a(4, k) = k > 0 ? k * std::pow(seconds, k - 1) : 0;
    a(5, k) = k > 1 ? k * (k - 1) * std::pow(seconds, k - 2) : 0;
  }
  Eigen::Matrix<double, 6, 2> b;
  b << from.position.transpose(), from.velocity.transpose(), from.acceleration.transpose(),
      to.position.transpose(), to.velocity.transpose(), to.acceleration.transpose();
  powers_ = a.inverse() * b;
}

QuinticPath::State QuinticPath::at(double t) const {
  t = std::clamp(t, 0.0, seconds_);
  State state{Vector2d::Zero(), Vector2d::Zero(), Vector2d::Zero()};
  for (int k = 5; k >= 0; --k) state.position = state.position * t + powers_.row(k).transpose();
  for (int k = 5; k >= 1; --k) state.velocity = state.velocity * t + k * powers_.row(k).transpose();
  for (int k = 5; k >= 2; --k)
    state.acceleration = state.acceleration * t + k * (k - 1) * powers_.row(k).transpose();
  return state;
}

Recordings demonstrate_juggling(const JuggleConfig& config) {
  return User(config).show();
}

GestureConfig juggling_phases(const JuggleConfig& config) {
  GestureConfig phases;
  phases.cycle = true;
  phases.window = kHandWindow;
  phases.min_seconds = kHandMinSeconds;
  phases.phases = {config.toss_ends == "toss" ? "toss: event toss" : "toss: v_y < 0",
                   "down: y < " + format_number(kBottomLine), "catch: event catch",
                   "return: near x=" + format_number(kHome.x()) + " y=" + format_number(kHome.y()) +
                       " by " + format_number(kHomeRadius)};
  return phases;
}

}  // namespace mocaplm
