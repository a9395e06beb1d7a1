#include "gesture/rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/angles.h"
#include "common/random.h"
#include "support/refusal.h"

namespace mocaplm::rule_test {
namespace {

const std::vector<std::string> kPlane = {"x", "y"};

// The time at which the rule says that the movement (2 coordinates of time) is over, or -1.
double over(const std::string& rule, const std::function<Eigen::Vector2d(double)>& movement,
            double min_seconds = 0, const std::string& event = "", double event_at = -1) {
  RuleWatcher watcher(parse_rule(rule, kPlane), min_seconds);
  MotionEstimator estimator(0.02);
  watcher.begin(0);
  const double step = 0.005;
  for (int i = 0; i <= 400; ++i) {
    const double t = i * step;
    const bool now = std::abs(t - event_at) < step / 2;
    if (const auto ago = watcher.push(estimator.push(t, movement(t)), now ? event : ""))
      return t - static_cast<double>(*ago) * step;
  }
  if (const auto ago = watcher.finish()) return 2 - static_cast<double>(*ago) * step;
  return -1;
}

// Up and down again: y = 1 - (t - 1)^2, x = t.
Eigen::Vector2d ballistic(double t) {
  return {t, 1 - (t - 1) * (t - 1)};
}

TEST(Rule, ThresholdsHoldWhereTheyShould) {
  EXPECT_NEAR(over("x > 0.5", ballistic), 0.505, 1e-9);
  EXPECT_NEAR(over("v_y < 0", ballistic), 1.0, 0.0051);
  EXPECT_NEAR(over("v_y < -1", ballistic, 0.1), 1.5, 0.0051);
  EXPECT_NEAR(over("a_y < -1", ballistic), 0.01, 1e-9) << "known from the third sample on";
  EXPECT_NEAR(over("near x=1.2 y=0.96 by 0.1", ballistic), 1.105, 0.0051);
  EXPECT_NEAR(over("near x=1.2 by 0.1", ballistic), 1.105, 0.0051);
  EXPECT_NEAR(over("speed < 1.01", ballistic, 0.1), 0.935, 0.0051);
  EXPECT_EQ(over("y > 2", ballistic), -1);
  EXPECT_NEAR(over("acceleration > 1.9", ballistic, 0.1), 0.1, 1e-9);
  EXPECT_NEAR(over("event catch", ballistic, 0, "catch", 0.7), 0.7, 1e-9);
  EXPECT_EQ(over("event catch", ballistic, 0, "toss", 0.7), -1);
  EXPECT_NEAR(over("", ballistic), 2, 1e-9) << "its time";
}

TEST(Rule, ASpeedMinimumIsFoundAfterItsRise) {
  // Speed |cos| of a swing: minimum at pi / 2 s after a peak at 0.
  const auto swing = [](double t) { return Eigen::Vector2d(std::sin(t), 0); };
  EXPECT_NEAR(over("speed minimum", swing), kPi / 2, 0.012);
  // Never below half of the peak.
  const auto wavy = [](double t) { return Eigen::Vector2d(t + 0.04 * std::sin(8 * t), 0); };
  EXPECT_EQ(over("speed minimum", wavy), -1);
  EXPECT_GT(over("speed minimum 0.9", wavy), 0);
  // The recording ends in rest.
  const auto stop = [](double t) { return Eigen::Vector2d(t < 1 ? std::sin(kPi * t / 2) : 1, 0); };
  EXPECT_GT(over("speed minimum", stop), 0.99);
}

TEST(Rule, NoiseDoesNotEndAPhase) {
  Random random(3);
  const auto noisy = [&](double t) {
    return Eigen::Vector2d(std::sin(t) + 2e-5 * random.normal(), 0);
  };
  EXPECT_NEAR(over("speed minimum", noisy), kPi / 2, 0.06);
}

TEST(MotionEstimator, IsExactForParabolasAndNoisyByTheBook) {
  MotionEstimator estimator(0.05);
  MotionState state;
  for (int i = 0; i <= 40; ++i) {
    const double t = 0.005 * i + 0.001 * (i % 3);  // uneven
    state = estimator.push(t, Eigen::Vector2d(3 + 2 * t - 4 * t * t, 1));
    if (i < 2) continue;
    EXPECT_NEAR(state.velocity(0), 2 - 8 * t, 1e-9) << i;
    EXPECT_NEAR(state.acceleration(0), -8, 1e-7) << i;
    EXPECT_NEAR(state.acceleration(1), 0, 1e-7);
  }
  // 11 samples at 200 Hz: the second derivative's deviation is sigma sqrt(720 / (n (n^2 - 1)
  // (n^2 - 4))) / dt^2 (Savitzky and Golay).
  Random random(5);
  MotionEstimator noisy(0.0501);
  double square = 0;
  int count = 0;
  for (int i = 0; i < 20000; ++i) {
    state = noisy.push(i * 0.005, Eigen::VectorXd::Constant(1, 0.001 * random.normal()));
    if (i < 20 || i % 11 != 0) continue;
    square += state.acceleration(0) * state.acceleration(0);
    ++count;
  }
  const double wanted = 0.001 * std::sqrt(720.0 / (11 * 120.0 * 117.0)) / (0.005 * 0.005);
  EXPECT_NEAR(std::sqrt(square / count) / wanted, 1, 0.07);
}

TEST(Rule, RefusesWhatCannotBeRead) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_PRED2(contains, refusal<UsageError>([&] { parse_rule(text, kPlane); }), part);
  };
  says("z < 1", "there is no \"z\"");
  says("v_z < 1", "coordinates: x, y");
  says("x = 1", "cannot be read");
  says("x <", "cannot be read");
  says("x < fast", "expected a number");
  says("x < nan", "expected a number");
  says("near x=1", "by DISTANCE");
  says("near x=1 by 0", "above 0");
  says("near z=1 by 1", "COORDINATE=NUMBER");
  says("near x by 1", "COORDINATE=NUMBER");
  says("speed minimum 2", "between 0 and 1");
  says("event", "cannot be read");
  EXPECT_THROW(parse_phases({": x < 1"}, kPlane), UsageError);
  EXPECT_THROW(parse_phases({"a", "a: x < 1"}, kPlane), UsageError);
  const auto phases = parse_phases({"up:  v_y  <  0 ", "rest"}, kPlane);
  EXPECT_EQ(phases[0].rule.text, "v_y < 0");
  EXPECT_EQ(phases[1].rule.kind, Rule::Kind::time);
}

}  // namespace
}  // namespace mocaplm::rule_test
