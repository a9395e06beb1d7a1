// Plays the phases of a model one after the other: a state machine whose states are the phases and
// whose transitions are their rules (II.E and II.H of Lippi, Avizzano and Ruffaldi 2012). One call
// a sample, so that it can be in a loop with an environment that answers.
#pragma once

#include <optional>

#include "common/random.h"
#include "gesture/adapt.h"
#include "gesture/model.h"

namespace mocaplm {

class GesturePlayer {
 public:
  // The model must outlive the player.
  explicit GesturePlayer(const GestureModel& model);

  // Begins a phase at `time`: P from the boundary, whose start is where the movement is now.
  void begin(std::size_t phase, double time, const Boundary& boundary);
  void begin(std::size_t phase, double time, const Boundary& boundary, const Eigen::MatrixXd& p);
  // A boundary of the phase from `start`: end, further conditions and T are those of the
  // demonstrations, the first two of one drawn by chance, T uniform between the shortest and the
  // longest (III.A). Where the conditions know of no place, the displacement is the
  // demonstration's instead of the end.
  Boundary draw(std::size_t phase, const Eigen::VectorXd& start, Random& random) const;

  // Where the movement should be (V); after T it stays at its end.
  Eigen::VectorXd position(double time) const;
  double tau(double time) const { return (time - began_) / boundary_.duration; }
  // Replans from `state` at `time` on.
  void correct(double time, const Eigen::VectorXd& state, const Eigen::VectorXd& target,
               Correction kind);

  enum class Step { going, rule, time };  // on, over by its rule, over by its time
  // Tells what was measured at the latest sample; says whether the phase is over. A phase is over
  // by its time at tau = 1, or after `grace` further seconds where its rule is an event.
  Step observe(const MotionState& state, const std::string& event, double grace = 0);
  // The phase that follows, or nothing after the last one of a model without a cycle.
  std::optional<std::size_t> next() const;

  std::size_t phase() const { return phase_; }
  const Boundary& boundary() const { return boundary_; }
  const Eigen::MatrixXd& coefficients() const { return p_; }

 private:
  const GestureModel& model_;
  std::size_t phase_ = 0;
  double began_ = 0;
  Boundary boundary_;
  Eigen::MatrixXd p_;
  std::optional<RuleWatcher> watcher_;
};

// All phases once (or `cycles` times), with ends and times drawn; the hand is where it is told to
// be. Rows are samples: what `mocaplm gesture play` writes without --phase.
struct PlayedMovement {
  Eigen::VectorXd time;             // (n)
  Eigen::MatrixXd values;           // (n, V)
  std::vector<std::string> phases;  // (n): the phase that the sample belongs to
  std::vector<std::string> ended;   // how each phase ended: "rule" or "time"
};
PlayedMovement play_all(const GestureModel& model, double rate, int cycles, std::uint64_t seed);

}  // namespace mocaplm
