#include "gesture/juggling/juggle.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "gesture/player.h"

namespace mocaplm {

namespace {

using Eigen::Vector2d;

constexpr std::size_t kPictureCycles = 5;
constexpr double kDeviation = 0.01;  // m: replanned from here on
constexpr double kGrace = 0.1;       // s: how long the hand waits for the ball
enum : std::size_t { kToss, kDown, kCatch, kReturn };

class Juggler {
 public:
  Juggler(const GestureModel& model, const JuggleConfig& config)
      : model_(model),
        config_(config),
        random_(static_cast<std::uint64_t>(config.seed) + 1000003),
        world_(config),
        player_(model) {
    for (const PhaseModel& phase : model.phases) {
      run_.phases.emplace_back();
      run_.phases.back().name = phase.name;
    }
    hand_ = model.phases[kToss].demonstrations[0].start;
    begin(kToss);
  }

  JuggleRun run() {
    while (run_.cycles < config_.cycles) step();
    return run_;
  }

 private:
  double now() const { return world_.time(); }

  void begin(std::size_t phase) {
    PhaseTally& tally = run_.phases[phase];
    ++tally.begun;
    began_ = now();
    peak_ = 0;
    offset_.setZero();
    // Planned from where the hand is seen to be.
    const Vector2d at =
        world_.hand().position.size() == 2 ? Vector2d(world_.hand().position) : hand_;
    Boundary boundary = player_.draw(phase, at, random_);
    if (phase == kCatch && !world_.held())
      boundary.end = Eigen::VectorXd(world_.ball_in(boundary.duration));
    Eigen::MatrixXd p = model_.phases[phase].coefficients(boundary);
    if (phase == kToss && config_.stop_toss)
      p = with_end_velocity(model_.phases[phase], p, {std::nullopt, 0.0}, boundary.duration,
                            EndVelocity::hyperplane);
    if (world_.hand().velocity.size() == 2) {
      const Eigen::VectorXd planned =
          p.transpose() * Basis(model_.phases[phase].harmonics).derivative(0) / boundary.duration;
      tally.jump.push_back((planned - world_.hand().velocity).norm());
    }
    player_.begin(phase, now(), boundary, p);
    gust_at_ = began_ + random_.uniform(0.1, 0.6) * boundary.duration;
    push_at_ = began_ + random_.uniform(0.1, 0.6) * boundary.duration;
  }

  // The hand follows its plan: off it by slow noise and by what pushed it.
  void move_hand() {
    const double keep = std::exp(-1 / (0.1 * config_.rate));  // forgets within 0.1 s
    for (Eigen::Index i = 0; i < 2; ++i)
      slip_(i) =
          keep * slip_(i) + std::sqrt(1 - keep * keep) * config_.tracking_noise * random_.normal();
    hand_ = Vector2d(player_.position(now() + 1 / config_.rate)) + slip_ + offset_;
  }

  void disturb() {
    if (player_.phase() != kCatch || world_.held()) return;
    if (now() >= gust_at_ && config_.gust > 0) {
      const double x = random_.normal(), y = random_.normal();
      world_.kick(config_.gust * Vector2d(x, y));
      gust_at_ = INFINITY;
    }
    if (now() >= push_at_ && config_.push > 0) {
      const double x = random_.normal(), y = random_.normal();
      offset_ += config_.push * Vector2d(x, y);
      push_at_ = INFINITY;
    }
  }

  void replan() {
    if (config_.correction == "none" || player_.phase() != kCatch || world_.held()) return;
    const double tau = player_.tau(now());
    if (tau < 0.02 || tau > 0.95) return;
    const double left = (1 - tau) * player_.boundary().duration;
    const Vector2d target = world_.ball_in(left), seen = world_.hand().position;
    const Vector2d planned = player_.position(now());
    if ((target - Vector2d(*player_.boundary().end)).norm() < kDeviation &&
        (seen - planned).norm() < kDeviation)
      return;
    const Correction kind = config_.correction == "minimum"  ? Correction::minimum
                            : config_.correction == "smooth" ? Correction::smooth
                                                             : Correction::hyperplane;
    player_.correct(now(), seen, target, kind);
    offset_.setZero();  // the plan begins where the hand is
    slip_.setZero();
    ++run_.corrections;
  }

  void step() {
    disturb();
    replan();
    move_hand();
    Vector2d seen = hand_;
    for (Eigen::Index i = 0; i < 2; ++i) seen(i) += config_.sensor_noise * random_.normal();
    const std::size_t phase = player_.phase();
    const bool armed = now() - began_ > kHandMinSeconds;
    const std::string event = world_.step(seen, phase == kToss && armed, phase == kCatch);
    peak_ = std::max(peak_, world_.hand().velocity.norm());
    if (run_.cycles < static_cast<std::int64_t>(kPictureCycles))
      run_.first.push_back({now(), seen, world_.ball(), phase, world_.held()});
    count(event);
    const auto ended = player_.observe(world_.hand(), event, kGrace);
    if (ended != GesturePlayer::Step::going) end(phase, ended == GesturePlayer::Step::rule);
  }

  void count(const std::string& event) {
    if (event == "toss") {
      ++run_.tosses;
      run_.toss_speed.push_back(world_.ball_velocity().y());
    } else if (event == "catch") {
      ++run_.catches;
      run_.longest = std::max(run_.longest, ++in_a_row_);
    } else if (event == "drop") {
      drop();
    }
  }

  void drop() {
    ++run_.drops;
    in_a_row_ = 0;
    world_.hold();
  }

  void end(std::size_t phase, bool by_rule) {
    PhaseTally& tally = run_.phases[phase];
    ++(by_rule ? tally.by_rule : tally.by_time);
    tally.seconds.push_back(now() - began_);
    tally.peak_speed.push_back(peak_);
    if (phase == kToss && world_.held()) {  // the hand never slowed down enough
      ++run_.missed_tosses;
      ++run_.cycles;
      begin(kReturn);
      return;
    }
    if (phase == kCatch && !world_.held()) drop();
    if (phase == kReturn) ++run_.cycles;
    begin(*player_.next());
  }

  const GestureModel& model_;
  const JuggleConfig& config_;
  Random random_;
  BallWorld world_;
  GesturePlayer player_;
  Vector2d hand_, slip_ = Vector2d::Zero(), offset_ = Vector2d::Zero();
  double began_ = 0, peak_ = 0, gust_at_ = 0, push_at_ = 0;
  std::int64_t in_a_row_ = 0;
  JuggleRun run_;
};

}  // namespace

JuggleRun juggle(const GestureModel& model, const JuggleConfig& config) {
  std::vector<std::string> names;
  for (const PhaseModel& phase : model.phases) names.push_back(phase.name);
  if (names != std::vector<std::string>{"toss", "down", "catch", "return"} ||
      model.phases[0].coordinates != std::vector<std::string>{"x", "y"} || !model.config.cycle)
    throw DataError(in_file(model.source),
                    "is a model of " + join(names, ", ") + " in " +
                        join(model.phases[0].coordinates, ", ") +
                        "; juggling needs the phases toss, down, catch and return of x and y, in "
                        "a cycle");
  for (const PhaseModel& phase : model.phases)
    for (const std::string& condition : phase.conditions)
      if (!is_own_condition(condition))
        throw DataError(in_file(model.source), "phase \"" + phase.name + "\" depends on \"" +
                                                   condition + "\", which juggling does not know");
  return Juggler(model, config).run();
}

JuggleRun tally_demonstrations(const Recordings& recordings, const GestureConfig& phases) {
  JuggleRun run;
  const Cut cut = cut_recordings(recordings, phases);
  for (const PhaseDemonstrations& phase : cut.phases) {
    PhaseTally tally;
    tally.name = phase.name;
    for (const Demonstration& one : phase.all) {
      MotionEstimator estimator(phases.window);
      double peak = 0;
      for (Eigen::Index i = 0; i < one.time.size(); ++i) {
        const MotionState state = estimator.push(one.time(i), one.values.row(i).transpose());
        // The first few samples know too little of the past.
        if (one.time(i) >= phases.window) peak = std::max(peak, state.velocity.norm());
      }
      tally.seconds.push_back(one.duration());
      tally.peak_speed.push_back(peak);
    }
    tally.begun = tally.by_rule = static_cast<std::int64_t>(phase.all.size());
    run.phases.push_back(tally);
  }
  for (const Recording& recording : recordings.all) {
    MotionEstimator estimator(phases.window);
    for (Eigen::Index i = 0; i < recording.time.size(); ++i) {
      const MotionState state =
          estimator.push(recording.time(i), recording.values.row(i).transpose());
      const std::string event =
          recording.events.empty() ? "" : recording.events[static_cast<std::size_t>(i)];
      if (event == "toss") run.toss_speed.push_back(state.velocity(1));
      run.tosses += event == "toss";
      run.catches += event == "catch";
    }
  }
  run.cycles = run.phases.empty() ? 0 : run.phases.back().begun;
  return run;
}

}  // namespace mocaplm
