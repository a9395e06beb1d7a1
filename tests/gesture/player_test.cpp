#include "gesture/player.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "gesture/made_up.h"

namespace mocaplm::player_test {
namespace {

// Two phases of the same movements: the first is over where x passes 1, the second with its time.
GestureModel two_phases(bool cycle) {
  const MadeUp made = made_up_movements(31, 30, 0.05);
  GestureModel model = fit_gesture(made.recordings, made_up_config());
  model.config.cycle = cycle;
  model.config.min_seconds = 0;
  model.phases.push_back(model.phases[0]);
  model.phases[0].name = "first";
  model.phases[0].rule = parse_rule("x > 1", {"x", "y"});
  model.phases[1].name = "second";
  return model;
}

TEST(GesturePlayer, FollowsItsPlanAndEndsByRuleOrTime) {
  const GestureModel model = two_phases(false);
  GesturePlayer player(model);
  MotionEstimator estimator(0.05);
  const Boundary boundary = boundary_between({0, 0}, {2, 1}, 1);
  player.begin(0, 5, boundary);
  EXPECT_LT((player.position(5) - boundary.start).norm(), 1e-12);
  EXPECT_LT((player.position(6) - *boundary.end).norm(), 1e-12);
  EXPECT_LT((player.position(9) - *boundary.end).norm(), 1e-12) << "it stays there";
  auto step = GesturePlayer::Step::going;
  double t = 5;
  while (step == GesturePlayer::Step::going && t < 8) {
    t += 0.005;
    step = player.observe(estimator.push(t, player.position(t)), "");
  }
  EXPECT_EQ(step, GesturePlayer::Step::rule);
  EXPECT_GT(player.position(t)(0), 1);
  EXPECT_LE(player.position(t - 0.005)(0), 1);
  EXPECT_EQ(player.next(), std::optional<std::size_t>(1));
  player.begin(1, t, boundary);
  EXPECT_EQ(player.next(), std::nullopt);
  step = player.observe(estimator.push(t + 1, player.position(t + 1)), "");
  EXPECT_EQ(step, GesturePlayer::Step::time);
}

// The past is what was played; from the correction on the movement goes another way.
TEST(GesturePlayer, ACorrectionBeginsAtTheState) {
  const GestureModel model = two_phases(false);
  GesturePlayer player(model);
  player.begin(1, 0, boundary_between({0, 0}, {2, 1}, 1));
  const Eigen::VectorXd state = player.position(0.4) + Eigen::Vector2d(0.1, 0.1);
  const Eigen::Vector2d target(2.5, 0.5);
  player.correct(0.4, state, target, Correction::smooth);
  EXPECT_LT((player.position(0.4) - state).norm(), 1e-9);
  EXPECT_LT((player.position(1) - target).norm(), 1e-9);
}

TEST(GesturePlayer, DrawsFromTheDemonstrations) {
  const GestureModel model = two_phases(true);
  const GesturePlayer player(model);
  Random random(32);
  std::set<double> ends;
  for (int i = 0; i < 300; ++i) {
    const Boundary boundary = player.draw(1, Eigen::Vector2d(7, 8), random);
    EXPECT_EQ(boundary.start, Eigen::VectorXd(Eigen::Vector2d(7, 8)));
    EXPECT_GE(boundary.duration, model.phases[1].shortest());
    EXPECT_LE(boundary.duration, model.phases[1].longest());
    ends.insert((*boundary.end)(0));
  }
  EXPECT_EQ(ends.size(), 30u);
}

TEST(GesturePlayer, PlaysAllPhasesWithoutAJump) {
  const GestureModel model = two_phases(true);
  const PlayedMovement played = play_all(model, 200, 5, 33);
  EXPECT_EQ(played.ended.size(), 10u);
  EXPECT_EQ(played.ended[1], "time");
  for (Eigen::Index i = 1; i < played.time.size(); ++i) {
    EXPECT_NEAR(played.time(i) - played.time(i - 1), 0.005, 1e-9);
    EXPECT_LT((played.values.row(i) - played.values.row(i - 1)).norm(), 0.25) << i;
  }
  EXPECT_EQ(play_all(model, 200, 5, 33).values, played.values);
  EXPECT_NE(play_all(model, 200, 5, 34).values.rows(), played.values.rows());
}

}  // namespace
}  // namespace mocaplm::player_test
