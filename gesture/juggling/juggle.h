// The closed loop of section III: a model trained from demonstrations juggles in the environment
// that they were recorded in.
//
// A phase is planned when it begins: its end and T are drawn from the demonstrations, but for the
// catch, whose end is where the ball will be at T. With stop_toss the toss gets a vertical speed of
// zero at its end (equation 9). On the way to the catch hand and ball are watched; when the hand is
// not where it should be, or the ball will not be, the movement is replanned (equation 10).
#pragma once

#include "gesture/juggling/ball_world.h"
#include "gesture/model.h"

namespace mocaplm {

struct JuggleSample {
  double time = 0;
  Eigen::Vector2d hand, ball;
  std::size_t phase = 0;
  bool held = true;
};

// What happened in one phase, over all cycles.
struct PhaseTally {
  std::string name;
  std::int64_t begun = 0, by_rule = 0, by_time = 0;
  std::vector<double> seconds, peak_speed;
  std::vector<double> jump;  // m/s: of the planned velocity against the hand's before the phase
};

struct JuggleRun {
  std::int64_t cycles = 0, tosses = 0, missed_tosses = 0, catches = 0, drops = 0;
  std::int64_t corrections = 0;
  std::int64_t longest = 0;        // catches in a row
  std::vector<double> toss_speed;  // m/s, vertical, of the ball as it leaves the hand
  std::vector<PhaseTally> phases;
  std::vector<JuggleSample> first;  // the samples of the first cycles, for a picture
};

// Runs config.cycles cycles. The model must have the phases toss, down, catch and return of x and y
// (DataError otherwise). A ball that falls is counted and taken up again.
JuggleRun juggle(const GestureModel& model, const JuggleConfig& config);

// The same figures of the demonstrations: vertical speeds at the toss, and of each phase its
// seconds and peak speeds (the two lists of PhaseTally).
JuggleRun tally_demonstrations(const Recordings& recordings, const GestureConfig& phases);

}  // namespace mocaplm
