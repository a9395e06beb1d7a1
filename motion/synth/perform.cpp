#include "motion/synth/perform.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/synth/smooth.h"

namespace mocaplm {

namespace {

constexpr double kBlend = 0.3;        // beats before and after a change of move in which both mix
constexpr double kSmoothing = 0.036;  // seconds: muscles know no corners
constexpr double kTopHitSpeed = 13;   // of an arm's hit, radians a second

// Slow, small, never quite repeating.
class Wander {
 public:
  Wander(double size, Random& random) {
    for (Wave& wave : waves_)
      wave = {size * random.uniform(0.4, 1.0), random.uniform(0.15, 1.1), random.uniform(0, kTurn)};
  }
  double at(double time) const {
    double sum = 0;
    for (const Wave& wave : waves_)
      sum += wave.size * std::sin(kTurn * wave.rate * time + wave.phase);
    return sum;
  }

 private:
  struct Wave {
    double size, rate, phase;
  };
  std::array<Wave, 3> waves_;
};

TorsoPose torso_pose(const TorsoFigure& figure, double beats, double attack_beats, double follow) {
  const double attack = std::clamp(attack_beats * figure.rate, 0.02, 0.45);
  const auto progress = [&](double u) {
    // The groove goes down on the beat.
    if (figure.curve == Curve::swing) return swing_curve(u + 0.5);
    return figure.curve == Curve::pulse ? pulse_curve(u, attack) : reach_curve(u);
  };
  const double u = beats * figure.rate;
  const double hips = progress(u), chest = progress(u - figure.lag - follow);
  const double side = std::sin(kTurn * 0.5 * u),
               late = std::sin(kTurn * 0.5 * (u - figure.lag - follow));
  const TorsoPose& full = figure.amount;
  TorsoPose pose;
  pose.pitch = full.pitch * chest;
  pose.nod = full.nod * chest;
  pose.down = full.down * hips;
  pose.sway_front = full.sway_front * hips;
  pose.hip_pitch = full.hip_pitch * hips;
  pose.heel = full.heel * hips;
  // To one side, then to the other.
  pose.roll = full.roll * late;
  pose.twist = full.twist * late;
  pose.look = full.look * late;
  pose.sway_left = full.sway_left * side;
  pose.hip_roll = full.hip_roll * side;
  pose.hip_twist = full.hip_twist * side;
  return pose;
}

TorsoPose flipped(TorsoPose pose) {
  for (double TorsoPose::*part :
       {&TorsoPose::roll, &TorsoPose::twist, &TorsoPose::look, &TorsoPose::sway_left,
        &TorsoPose::hip_roll, &TorsoPose::hip_twist})
    pose.*part = -(pose.*part);
  return pose;
}

// The moves with the beat on which each begins.
class Timeline {
 public:
  explicit Timeline(const std::vector<Move>& moves) : moves_(moves) {
    for (const Move& move : moves) {
      starts_.push_back(end_);
      end_ += move.beats;
    }
  }

  // Calls use(move, beats since it began, weight) for the moves that share `beat`; weights sum to
  // one.
  template <class Use>
  void at(double beat, Use use) const {
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), beat);
    const std::size_t i =
        after == starts_.begin() ? 0 : static_cast<std::size_t>(after - starts_.begin()) - 1;
    const double since = beat - starts_[i], left = moves_[i].beats - since;
    if (i > 0 && since < kBlend) {
      const double weight = ease((since + kBlend) / (2 * kBlend));
      use(moves_[i - 1], held(moves_[i - 1], beat - starts_[i - 1]), 1 - weight);
      use(moves_[i], held(moves_[i], since), weight);
    } else if (i + 1 < moves_.size() && left < kBlend) {
      const double weight = ease((kBlend - left) / (2 * kBlend));
      use(moves_[i], held(moves_[i], since), 1 - weight);
      use(moves_[i + 1], -left, weight);
    } else {
      use(moves_[i], held(moves_[i], since), 1.0);
    }
  }

  double start(std::size_t i) const { return starts_[i]; }

 private:
  // A frozen move stays as it was a beat before its end.
  static double held(const Move& move, double since) {
    return move.freeze ? std::min(since, move.beats - 1) : since;
  }

  const std::vector<Move>& moves_;
  std::vector<double> starts_;
  double end_ = 0;
};

ArmPose styled(const ArmPose& pose, const Style& style, double size, int side) {
  const ArmPose middle{-0.4, 0.5, -0.1, 0.9, 0};
  const double scale =
      size * style.amplitude * (1 + (side == 0 ? style.asymmetry : -style.asymmetry));
  ArmPose out = middle + scale * (pose + -1.0 * middle);
  out.raise += style.reach;
  out.bend += style.elbow;
  return out;
}

std::vector<PlannedStep> plan_steps(const std::vector<Move>& moves, const Timeline& timeline,
                                    const Music& music, double timing) {
  std::vector<PlannedStep> steps;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const FootFigure figure = moves[i].flipped ? mirrored(moves[i].feet) : moves[i].feet;
    const double last = moves[i].beats - (moves[i].freeze ? 1 : 0);
    for (double round = 0; round < last; round += figure.beats)
      for (const Step& step : figure.steps)
        if (round + step.beat < last)
          steps.push_back(
              {step, (timeline.start(i) + round + step.beat) * music.beat_seconds() + timing});
  }
  return steps;
}

// Torso and arms at any time: the moves that are due, in the dancer's style, with the day's
// wandering.
class Dancer {
 public:
  Dancer(const Timeline& timeline, const Genre& genre, const Style& style, const Music& music,
         Random& random)
      : timeline_(timeline),
        genre_(genre),
        style_(style),
        beat_seconds_(music.beat_seconds()),
        attack_(std::max(0.16, genre.attack / style.sharpness) / beat_seconds_) {
    for (int i = 0; i < 8; ++i) arm_wander_.emplace_back(0.035, random);
    for (int i = 0; i < 4; ++i) torso_wander_.emplace_back(0.02, random);
    effort_.emplace_back(0.08, random);
  }

  void pose(double time, Performance& out) const {
    const double size = 1 + effort_[0].at(time);
    TorsoPose torso = carriage(time);
    std::array<ArmPose, 2> arms = {arm_drift(0, time), arm_drift(1, time)};
    timeline_.at((time - style_.timing) / beat_seconds_,
                 [&](const Move& move, double since, double weight) {
                   torso = torso + weight * torso_of(move, since, size);
                   for (int side = 0; side < 2; ++side) {
                     ArmPose& arm = arms[static_cast<std::size_t>(side)];
                     arm = arm + weight * arm_of(move, side, since, size);
                   }
                 });
    out.torso.push_back(torso);
    for (std::size_t side = 0; side < 2; ++side) out.arms[side].push_back(arms[side]);
  }

 private:
  // How the torso is held under all that it does.
  TorsoPose carriage(double time) const {
    TorsoPose pose;
    pose.pitch = style_.posture + torso_wander_[0].at(time);
    pose.roll = style_.lean + torso_wander_[1].at(time);
    pose.twist = torso_wander_[2].at(time);
    pose.look = 2 * torso_wander_[3].at(time);
    pose.nod = style_.chin;
    pose.down = style_.bend + genre_.bend;
    return pose;
  }

  ArmPose arm_drift(std::size_t side, double time) const {
    const Wander* w = &arm_wander_[4 * side];
    return {w[0].at(time), w[1].at(time), w[2].at(time), w[3].at(time), 0};
  }

  TorsoPose torso_of(const Move& move, double since, double size) const {
    const TorsoPose pose = torso_pose(move.torso, since, attack_, style_.follow);
    const double drive = size * move.size * genre_.drive * style_.bounce;
    TorsoPose danced = drive * (move.flipped ? flipped(pose) : pose);
    danced.down += move.feet.bend;
    return danced;
  }

  ArmPose arm_of(const Move& move, int side, double since, double size) const {
    // A longer way takes longer: arms have a top speed.
    const double way = arm_travel(move.arms) * size * move.size * style_.amplitude;
    const double attack = std::max(attack_, 1.9 * way / kTopHitSpeed / beat_seconds_);
    const ArmPose pose = arm_pose(move.arms, move.flipped ? 1 - side : side, since, attack);
    return styled(pose, style_, size * move.size, side);
  }

  const Timeline& timeline_;
  const Genre& genre_;
  const Style& style_;
  double beat_seconds_, attack_;  // attack in beats
  std::vector<Wander> arm_wander_, torso_wander_, effort_;
};

}  // namespace

TorsoPose operator+(const TorsoPose& a, const TorsoPose& b) {
  return {a.pitch + b.pitch,         a.roll + b.roll,
          a.twist + b.twist,         a.nod + b.nod,
          a.look + b.look,           a.down + b.down,
          a.sway_left + b.sway_left, a.sway_front + b.sway_front,
          a.hip_roll + b.hip_roll,   a.hip_twist + b.hip_twist,
          a.hip_pitch + b.hip_pitch, a.heel + b.heel};
}

TorsoPose operator*(double s, const TorsoPose& a) {
  return {s * a.pitch,    s * a.roll,      s * a.twist,     s * a.nod,
          s * a.look,     s * a.down,      s * a.sway_left, s * a.sway_front,
          s * a.hip_roll, s * a.hip_twist, s * a.hip_pitch, s * a.heel};
}

Performance perform(const std::vector<Move>& moves, const Genre& genre, const Style& style,
                    const Music& music, double fps, Eigen::Index frames, Random& random) {
  const Timeline timeline(moves);
  const Dancer dancer(timeline, genre, style, music, random);
  Performance out;
  out.fps = fps;
  for (Eigen::Index t = 0; t < frames; ++t) dancer.pose(static_cast<double>(t) / fps, out);
  const std::vector<double> kernel = bell(kSmoothing * fps);
  out.torso = smoothed(out.torso, kernel);
  for (auto& arm : out.arms) arm = smoothed(arm, kernel);

  Stance stance;
  stance.width = style.width;
  stance.turnout = style.turnout;
  stance.step_scale = style.step_scale;
  stance.heading = 0.3 * random.normal();
  out.feet = plan_feet(plan_steps(moves, timeline, music, style.timing), stance, fps, frames);
  return out;
}

}  // namespace mocaplm
