// A made-up user who shows the task: tosses the ball up and to the left, goes down to the bottom of
// the screen, catches the ball, returns. Movements are quintic polynomials between positions,
// velocities and accelerations (as of Flash and Hogan 1985, minimum jerk), with places and times
// that scatter, and smooth deviations on the way; the tracker adds its noise.
#pragma once

#include "common/random.h"
#include "gesture/config.h"
#include "gesture/juggling/config.h"
#include "gesture/recording.h"

namespace mocaplm {

// One recording "user" of config.demonstrations cycles, sampled at config.rate, with the events
// toss and catch: coordinates x, y. A cycle whose ball is dropped is shown again, from a new
// recording on ("user 2", ...). Throws UsageError when the settings make the task impossible: the
// user drops ten balls in a row, or none leaves the hand.
Recordings demonstrate_juggling(const JuggleConfig& config);

// How these recordings are cut, and what the model is made of: phases toss, down, catch and
// return.
GestureConfig juggling_phases(const JuggleConfig& config);

// From position, velocity and acceleration (2) to others within `seconds`.
class QuinticPath {
 public:
  struct State {
    Eigen::Vector2d position, velocity, acceleration;
  };
  QuinticPath() = default;
  QuinticPath(const State& from, const State& to, double seconds);
  // The state at t in [0, seconds]; before and after it that of the ends.
  State at(double t) const;
  double seconds() const { return seconds_; }

 private:
  Eigen::Matrix<double, 6, 2> powers_ = Eigen::Matrix<double, 6, 2>::Zero();
  double seconds_ = 1;
};

}  // namespace mocaplm
