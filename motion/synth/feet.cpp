#include "motion/synth/feet.h"

#include <algorithm>
#include <cmath>

#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/synth/beat.h"

namespace mocaplm {

namespace {

constexpr double kShortestSwing = 0.13;  // seconds
constexpr double kTopStepSpeed = 1.3;    // of a step, metres a second on average
constexpr double kTopTurn = 3.5;         // of a foot, radians a second on average
constexpr double kRoom = 1.2;            // metres from the middle at which a dancer turns back
// A foot travels only while it is well over the floor: nothing skates.
constexpr double kLeaveFloor = 0.2;

struct FootPlace {
  Eigen::Vector2d spot = Eigen::Vector2d::Zero();  // world x, z
  double yaw = 0;
};

struct Swing {
  double start = 0, end = 0;  // seconds
  FootPlace from, to;
  double lift = 0, kick = 0;
};

struct Turn {
  double start = 0, end = 0, angle = 0;
};

Eigen::Vector2d turned(double heading, double left, double front) {
  const double c = std::cos(heading), s = std::sin(heading);
  return {c * left + s * front, -s * left + c * front};
}

// 0 at both ends with no speed, 1 in the middle.
double bump(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return 16 * x * x * (1 - x) * (1 - x);
}

double outwards(int foot) {
  return foot == 0 ? 1 : -1;
}

// Walks through the steps and remembers every swing.
class Planner {
 public:
  explicit Planner(const Stance& stance) : stance_(stance), heading_(stance.heading) {
    for (int foot = 0; foot < 2; ++foot) feet_[foot] = place(foot, Step{});
    first_ = feet_;
  }

  void take(const PlannedStep& planned) {
    const int foot = planned.step.foot;
    const double free = planned.time - std::max(landed_[0], landed_[1]);
    const double longest = stance_.swing * (planned.step.kick > 0 ? 1.4 : 1);
    const double time = std::min(longest, 0.92 * free);
    if (time < kShortestSwing) return;
    Step step = planned.step;
    heading_ += step.turn;
    if (step.turn != 0) turns.push_back({planned.time - time, planned.time, step.turn});
    move(step);
    Swing swing{planned.time - time, planned.time, feet_[foot], place(foot, step), 0, 0};
    shorten(swing, time);
    // Hurried steps are lower.
    const double calm = std::min(1.0, time / 0.36);
    const double way = (swing.to.spot - swing.from.spot).norm();
    swing.lift = calm * step.lift + 0.12 * way;
    swing.kick = calm * step.kick;
    feet_[foot] = swing.to;
    landed_[foot] = planned.time;
    swings[foot].push_back(swing);
  }

  FootPlace first(int foot) const { return first_[foot]; }

  std::array<std::vector<Swing>, 2> swings;
  std::vector<Turn> turns;

 private:
  FootPlace place(int foot, const Step& step) const {
    const double out = stance_.width + stance_.step_scale * step.out;
    FootPlace place;
    place.spot = centre_ + turned(heading_, outwards(foot) * out, stance_.step_scale * step.front);
    place.yaw = heading_ + outwards(foot) * stance_.turnout;
    return place;
  }

  // A foot goes only as far as it can in its time; the next step makes up for the rest.
  static void shorten(Swing& swing, double time) {
    const Eigen::Vector2d way = swing.to.spot - swing.from.spot;
    const double share = std::min(1.0, kTopStepSpeed * time / std::max(1e-9, way.norm()));
    swing.to.spot = swing.from.spot + share * way;
    const double turn = swing.to.yaw - swing.from.yaw;
    swing.to.yaw = swing.from.yaw + std::clamp(turn, -kTopTurn * time, kTopTurn * time);
  }

  void move(const Step& step) {
    const Eigen::Vector2d way =
        stance_.step_scale * turned(heading_, step.move_left, step.move_front);
    // Too far from the middle a step goes the other way, so that nobody dances out of the room.
    const bool outside = (centre_ + way).norm() > std::max(kRoom, centre_.norm());
    centre_ += outside ? -way : way;
  }

  Stance stance_;
  double heading_;
  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
  std::array<FootPlace, 2> feet_, first_;
  std::array<double, 2> landed_ = {-1e-9, -1e-9};
};

// Where a foot is at `time`; `swings` in order, `next` the first that has not ended yet.
void set_foot(FootPath& path, Eigen::Index frame, double time, const std::vector<Swing>& swings,
              std::size_t& next, FootPlace& place) {
  while (next < swings.size() && time >= swings[next].end) place = swings[next++].to;
  FootPlace now = place;
  double lift = 0, pitch = 0;
  if (next < swings.size() && time > swings[next].start) {
    const Swing& swing = swings[next];
    const double x = (time - swing.start) / (swing.end - swing.start);
    const double way = ease((x - kLeaveFloor) / (1 - 2 * kLeaveFloor));
    now.spot = swing.from.spot + way * (swing.to.spot - swing.from.spot);
    now.yaw = swing.from.yaw + way * (swing.to.yaw - swing.from.yaw);
    const double shot = bump((x - kLeaveFloor) / (1 - 2 * kLeaveFloor));
    now.spot += shot * swing.kick * turned(now.yaw, 0, 1);
    lift = bump(x) * swing.lift + shot * 0.9 * swing.kick;
    pitch = bump(x) * (0.35 - 0.3 * way);
  }
  path.toe.row(frame) << now.spot.x(), kToeHeight + lift, now.spot.y();
  path.yaw(frame) = now.yaw;
  path.pitch(frame) = pitch;
}

// How much of its weight a foot has given away: all of it in the middle of its swing.
double unloaded(const std::vector<Swing>& swings, double time) {
  double most = 0;
  for (const Swing& swing : swings) {
    const double margin = 0.1;  // seconds in which the weight goes over before and after
    const double x = (time - swing.start + margin) / (swing.end - swing.start + 2 * margin);
    if (x > 0 && x < 1) most = std::max(most, bump(x));
  }
  return most;
}

}  // namespace

FootFigure mirrored(FootFigure figure) {
  for (Step& step : figure.steps) {
    step.foot = 1 - step.foot;
    step.move_left = -step.move_left;
    step.turn = -step.turn;
  }
  return figure;
}

FootPlan plan_feet(const std::vector<PlannedStep>& steps, const Stance& stance, double fps,
                   Eigen::Index frames) {
  Planner planner(stance);
  for (const PlannedStep& step : steps) planner.take(step);
  FootPlan plan;
  plan.heading.setConstant(frames, stance.heading);
  plan.weight.setConstant(frames, 0.5);
  for (int foot = 0; foot < 2; ++foot) {
    const std::size_t side = static_cast<std::size_t>(foot);
    FootPath& path = plan.feet[side];
    path.toe.resize(frames, 3);
    path.yaw.resize(frames);
    path.pitch.resize(frames);
    std::size_t next = 0;
    FootPlace place = planner.first(foot);
    for (Eigen::Index t = 0; t < frames; ++t) {
      const double time = static_cast<double>(t) / fps;
      set_foot(path, t, time, planner.swings[side], next, place);
      plan.weight(t) -= 0.5 * outwards(foot) * unloaded(planner.swings[side], time);
    }
  }
  for (Eigen::Index t = 0; t < frames; ++t)
    for (const Turn& turn : planner.turns) {
      const double time = static_cast<double>(t) / fps;
      plan.heading(t) += turn.angle * ease((time - turn.start) / (turn.end - turn.start));
    }
  return plan;
}

Eigen::Vector3d toe_to_ankle(int side) {
  const RestJoints& rest = rest_joints();
  return (rest.row(7 + side) - rest.row(10 + side)).transpose();
}

Eigen::Matrix3d foot_rotation(double yaw, double pitch) {
  return matrix_from_axis_angle(yaw * Eigen::Vector3d::UnitY()) *
         matrix_from_axis_angle(pitch * Eigen::Vector3d::UnitX());
}

}  // namespace mocaplm
