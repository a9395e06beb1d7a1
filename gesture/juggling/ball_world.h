// The virtual environment: a ball that falls, and a hand that holds, tosses and touches it. A
// plane, x to the right, y up, metres and seconds.
#pragma once

#include <Eigen/Core>
#include <string>

#include "gesture/juggling/config.h"
#include "gesture/rule.h"

namespace mocaplm {

class BallWorld {
 public:
  explicit BallWorld(const JuggleConfig& config);

  // One sample later the tracker sees the hand at `hand`. Returns what happened: "toss", "catch",
  // "drop" (the ball fell below the screen, y = -0.6) or "". The ball is tossed when the hand's
  // vertical acceleration falls below the threshold while `tossing`; it flies on with the hand's
  // velocity. It is caught when the hand touches it while `catching`.
  std::string step(const Eigen::Vector2d& hand, bool tossing, bool catching);
  // The hand takes the ball up again.
  void hold() { held_ = true; }
  void kick(const Eigen::Vector2d& velocity) { velocity_ += velocity; }

  double time() const { return static_cast<double>(steps_) / rate_; }
  bool held() const { return held_; }
  const Eigen::Vector2d& ball() const { return ball_; }
  const Eigen::Vector2d& ball_velocity() const { return velocity_; }
  const MotionState& hand() const { return hand_; }  // as the tracker sees it
  // Where a flying ball will be.
  Eigen::Vector2d ball_in(double seconds) const;

 private:
  double rate_, gravity_, threshold_, radius_;
  std::int64_t steps_ = 0;
  bool held_ = true;
  Eigen::Vector2d ball_ = Eigen::Vector2d::Zero(), velocity_ = Eigen::Vector2d::Zero();
  MotionEstimator estimator_;
  MotionState hand_;
};

// Seconds of the past that speed and acceleration of the hand are worked out from: at 200 Hz and
// 0.3 mm of noise the acceleration is then known to 1 m/s2.
constexpr double kHandWindow = 0.05;
// A phase lasts at least this long: the hand comes home, and only then goes up to toss.
constexpr double kHandMinSeconds = 0.2;

}  // namespace mocaplm
