// When a phase ends (II.D of the paper: "the segmentation criteria should be based on data
// available online"). The same rules cut recordings and drive the state machine, one sample at a
// time.
//
//   y < 0.2    v_y < 0    a_y < -6    speed < 0.1    acceleration > 20
//              a coordinate, its speed (v_) or acceleration (a_), or their lengths over all
//              coordinates; also with >
//   near x=0.2 y=0 by 0.05      these coordinates are closer to the point than that
//   speed minimum               the speed had a peak, fell below half of it and rises again; the
//   speed minimum 0.3           phase ends at the minimum. Another share than half
//   event catch                 the environment said so
//   (nothing)                   its time T is over
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace mocaplm {

struct Rule {
  enum class Kind { time, compare, near, speed_minimum, event };
  enum class Signal { position, velocity, acceleration, speed, total_acceleration };

  std::string text;
  Kind kind = Kind::time;
  Signal signal = Signal::position;
  Eigen::Index coordinate = 0;
  bool below = true;
  double value = 0;  // threshold, radius, or share of the peak
  std::vector<std::pair<Eigen::Index, double>> point;
  std::string event;
};

// Throws UsageError with what can be said instead.
Rule parse_rule(const std::string& text, const std::vector<std::string>& coordinates);

struct PhaseRule {
  std::string name;
  Rule rule;
};
// "NAME: RULE", or a NAME alone. Throws UsageError, also for a name twice.
std::vector<PhaseRule> parse_phases(const std::vector<std::string>& texts,
                                    const std::vector<std::string>& coordinates);

// What is known of a movement at its latest sample.
struct MotionState {
  double time = 0;
  Eigen::VectorXd position, velocity, acceleration;
};

// Position, velocity and acceleration at the latest sample: the parabola of least squares through
// the last `window` seconds, 4 samples at least; below 3 samples velocity and acceleration are 0.
// The position is the sample itself.
class MotionEstimator {
 public:
  explicit MotionEstimator(double window) : window_(window) {}
  MotionState push(double time, const Eigen::VectorXd& position);
  void clear() { past_.clear(); }

 private:
  double window_;
  std::deque<std::pair<double, Eigen::VectorXd>> past_;
};

// Says when a phase is over.
class RuleWatcher {
 public:
  RuleWatcher(Rule rule, double min_seconds) : rule_(std::move(rule)), min_seconds_(min_seconds) {}
  void begin(double time);
  // The number of samples since the phase ended (0: it ends at this sample), or nothing.
  std::optional<std::size_t> push(const MotionState& state, const std::string& event);
  // The same when the recording ends here: a speed minimum need not be followed by a rise.
  std::optional<std::size_t> finish() const;

 private:
  bool holds(const MotionState& state, const std::string& event) const;
  std::optional<std::size_t> push_speed(const MotionState& state);

  Rule rule_;
  double min_seconds_, began_ = 0;
  double peak_ = 0, lowest_ = 0;
  std::size_t since_lowest_ = 0;
};

}  // namespace mocaplm
