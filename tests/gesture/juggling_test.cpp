// The task of section III: environment, made-up user, and the model that juggles.
#include <gtest/gtest.h>

#include <cmath>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "gesture/juggling/demonstrator.h"
#include "gesture/juggling/juggle.h"
#include "support/refusal.h"

namespace mocaplm::juggling_test {
namespace {

using Eigen::Vector2d;

JuggleConfig quiet() {
  JuggleConfig config;
  config.sensor_noise = config.tracking_noise = 0;
  return config;
}

TEST(BallWorld, TossesWithTheHandsVelocityAndFallsByTheBook) {
  JuggleConfig config = quiet();
  BallWorld world(config);
  std::string event;
  double t = 0;
  // Up, ever slower: y = 1.5 t - 3.5 t^2, a = -7.
  const auto hand = [](double s) { return Vector2d(-0.3 * s, 1.5 * s - 3.5 * s * s); };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(world.step(hand(t = (i + 1) * 0.005), false, false), "");
  EXPECT_EQ(world.ball(), hand(t)) << "held";
  event = world.step(hand(t = 0.02), true, false);
  ASSERT_EQ(event, "toss");
  EXPECT_NEAR(world.ball_velocity().x(), -0.3, 1e-9);
  EXPECT_NEAR(world.ball_velocity().y(), 1.5 - 7 * 0.02, 1e-9);
  const Vector2d from = world.ball(), speed = world.ball_velocity();
  const Vector2d predicted = world.ball_in(0.5);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(world.step(Vector2d(9, 9), false, true), "");
  EXPECT_LT((world.ball() - (from + 0.5 * speed - Vector2d(0, 3 * 0.125))).norm(), 1e-9);
  EXPECT_LT((world.ball() - predicted).norm(), 1e-9);
  EXPECT_NEAR(world.ball_velocity().y(), speed.y() - 1.5, 1e-9);
}

TEST(BallWorld, CatchesWithinTheRadiusOnly) {
  JuggleConfig config = quiet();
  for (const double distance : {0.04, 0.06}) {
    BallWorld world(config);
    for (int i = 0; i < 4; ++i) {
      const double t = i * 0.005;
      world.step(Vector2d(0, 1.5 * t - 3.5 * t * t), i == 3, false);
    }
    ASSERT_FALSE(world.held());
    const Vector2d next = world.ball_in(0.005) + Vector2d(distance, 0);
    EXPECT_EQ(world.step(next, false, false), "") << "the hand is not open";
    const Vector2d then = world.ball_in(0.005) + Vector2d(distance, 0);
    EXPECT_EQ(world.step(then, false, true), distance < 0.05 ? "catch" : "");
  }
}

TEST(BallWorld, WhatIsNotCaughtDrops) {
  BallWorld world(quiet());
  for (int i = 0; i < 4; ++i) {
    const double t = i * 0.005;
    world.step(Vector2d(0, 1.5 * t - 3.5 * t * t), i == 3, false);
  }
  int steps = 0;
  while (world.step(Vector2d(5, 5), false, true) != "drop") ASSERT_LT(++steps, 1000);
  EXPECT_LT(world.ball().y(), -0.6);
}

TEST(QuinticPath, MeetsItsEndsAndItsDerivatives) {
  const QuinticPath::State a{{1, 2}, {0.3, -1}, {2, 0}}, b{{-1, 0.5}, {0, 0.7}, {-3, 1}};
  const QuinticPath path(a, b, 0.7);
  for (const bool end : {false, true}) {
    const QuinticPath::State at = path.at(end ? 0.7 : 0);
    const QuinticPath::State& wanted = end ? b : a;
    EXPECT_LT((at.position - wanted.position).norm(), 1e-9);
    EXPECT_LT((at.velocity - wanted.velocity).norm(), 1e-9);
    EXPECT_LT((at.acceleration - wanted.acceleration).norm(), 1e-8);
  }
  const double h = 1e-5;
  EXPECT_LT(
      (path.at(0.3).velocity - (path.at(0.3 + h).position - path.at(0.3 - h).position) / (2 * h))
          .norm(),
      1e-7);
  EXPECT_LT((path.at(0.3).acceleration -
             (path.at(0.3 + h).velocity - path.at(0.3 - h).velocity) / (2 * h))
                .norm(),
            1e-6);
}

TEST(Demonstrator, ShowsEveryPhaseOnceACycle) {
  JuggleConfig config;
  config.demonstrations = 20;
  const Recordings shown = demonstrate_juggling(config);
  const Cut cut = cut_recordings(shown, juggling_phases(config));
  ASSERT_EQ(cut.phases.size(), 4u);
  // Of a recording that ends in a drop the last phases are missing.
  for (const PhaseDemonstrations& phase : cut.phases)
    EXPECT_GE(phase.all.size(), 19u) << phase.name;
  const JuggleRun tally = tally_demonstrations(shown, juggling_phases(config));
  EXPECT_GE(tally.tosses, 20);
  EXPECT_GE(tally.catches, 20);
  EXPECT_EQ(recordings_csv(demonstrate_juggling(config)), recordings_csv(shown));
  config.seed = 2;
  EXPECT_NE(recordings_csv(demonstrate_juggling(config)), recordings_csv(shown));
}

TEST(Demonstrator, RefusesAnImpossibleTask) {
  JuggleConfig config;
  config.toss_threshold = 60;
  EXPECT_PRED2(contains, refusal<UsageError>([&] { demonstrate_juggling(config); }),
               "toss_threshold");
  config = JuggleConfig();
  config.gravity = 20;
  EXPECT_THROW(demonstrate_juggling(config), UsageError);
}

GestureModel model_of(const JuggleConfig& config) {
  return fit_gesture(demonstrate_juggling(config), juggling_phases(config));
}

TEST(Juggle, AModelOfDemonstrationsJuggles) {
  JuggleConfig config;
  config.cycles = 100;
  const GestureModel model = model_of(config);
  const JuggleRun run = juggle(model, config);
  EXPECT_EQ(run.cycles, 100);
  EXPECT_GE(run.tosses, 98);
  EXPECT_GE(run.catches, 97);
  EXPECT_EQ(run.tosses, run.catches + run.drops);
  const JuggleRun again = juggle(model, config);
  EXPECT_EQ(again.toss_speed, run.toss_speed) << "the same seed";
  config.seed = 5;
  EXPECT_NE(juggle(model, config).toss_speed, run.toss_speed);
}

TEST(Juggle, ReplanningCatchesWhatWouldBeMissed) {
  JuggleConfig config;
  config.cycles = 100;
  config.push = 0.08;
  const GestureModel model = model_of(config);
  config.correction = "none";
  const JuggleRun without = juggle(model, config);
  EXPECT_LT(without.catches, 90);
  EXPECT_EQ(without.corrections, 0);
  for (const char* correction : {"minimum", "smooth", "hyperplane"}) {
    config.correction = correction;
    const JuggleRun with = juggle(model, config);
    EXPECT_GT(with.catches, without.catches) << correction;
    EXPECT_GT(with.corrections, 50) << correction;
  }
}

TEST(Juggle, NeedsItsPhases) {
  JuggleConfig config;
  config.demonstrations = 15;
  GestureModel model = model_of(config);
  std::swap(model.phases[0], model.phases[1]);
  EXPECT_PRED2(contains, refusal([&] { juggle(model, config); }), "toss, down, catch and return");
}

}  // namespace
}  // namespace mocaplm::juggling_test
