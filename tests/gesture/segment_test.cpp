#include "gesture/segment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "support/refusal.h"

namespace mocaplm::segment_test {
namespace {

// x goes to 1 and back within 2 s, `times` times, at 100 Hz.
Recordings swings(int times) {
  Recordings all;
  all.source = "swings";
  all.coordinates = {"x"};
  Recording one;
  one.name = "s";
  const Eigen::Index n = 200 * times + 1;
  one.time = Eigen::VectorXd::LinSpaced(n, 0, 2 * times);
  one.values = (1 - (kPi * one.time.array()).cos()) / 2;
  one.more.resize(n, 0);
  all.all.push_back(one);
  return all;
}

GestureConfig out_and_back() {
  GestureConfig config;
  config.phases = {"out: v_x < 0", "back: speed minimum"};
  config.min_seconds = 0.3;
  return config;
}

TEST(Segment, CutsOnceOrInACycle) {
  GestureConfig config = out_and_back();
  Cut cut = cut_recordings(swings(3), config);
  EXPECT_EQ(cut.phases[0].all.size(), 1u);
  EXPECT_EQ(cut.phases[1].all.size(), 1u);
  config.cycle = true;
  cut = cut_recordings(swings(3), config);
  ASSERT_EQ(cut.phases[0].all.size(), 3u);
  EXPECT_EQ(cut.phases[1].all.size(), 3u);
  EXPECT_EQ(cut.phases[0].all[2].name, "s (3)");
  for (const Demonstration& one : cut.phases[1].all) {
    EXPECT_NEAR(one.start()(0), 1, 0.01);
    EXPECT_NEAR(one.end()(0), 0, 0.01);
    EXPECT_NEAR(one.duration(), 1, 0.08);
    EXPECT_EQ(one.time(0), 0);
  }
  EXPECT_EQ(cut.unfinished, 0u);
}

TEST(Segment, APhaseBeginsWhereTheOneBeforeEnds) {
  const Cut cut = cut_recordings(swings(1), out_and_back());
  EXPECT_EQ(cut.phases[0].all[0].end(), cut.phases[1].all[0].start());
}

TEST(Segment, AColumnCutsToo) {
  Recordings all = swings(1);
  auto& phases = all.all[0].phases;
  for (int i = 0; i <= 200; ++i) phases.push_back(i < 80 ? "a" : "b");
  const Cut cut = cut_recordings(all, {});
  ASSERT_EQ(cut.phases.size(), 2u);
  EXPECT_EQ(cut.phases[0].name, "a");
  EXPECT_EQ(cut.phases[0].all[0].time.size(), 81);
  EXPECT_EQ(cut.phases[1].all[0].time.size(), 121);
  phases[3] = "";
  EXPECT_PRED2(contains, refusal([&] { cut_recordings(all, {}); }), "without a phase");
}

TEST(Segment, WithoutRulesARecordingIsAMovement) {
  const Cut cut = cut_recordings(swings(1), {});
  ASSERT_EQ(cut.phases.size(), 1u);
  EXPECT_EQ(cut.phases[0].all[0].time.size(), 201);
}

TEST(Segment, PhasesCanBeLeftOut) {
  GestureConfig config = out_and_back();
  config.leave_out = {"out"};
  EXPECT_EQ(cut_recordings(swings(1), config).phases[0].name, "back");
  config.leave_out = {"out", "back"};
  EXPECT_THROW(cut_recordings(swings(1), config), UsageError);
  config.leave_out = {"ot"};
  EXPECT_PRED2(contains, refusal<UsageError>([&] { cut_recordings(swings(1), config); }), "out");
}

TEST(Segment, RefusesPiecesThatAreNone) {
  GestureConfig config = out_and_back();
  config.phases = {"out: x > 5"};
  EXPECT_PRED2(contains, refusal([&] { cut_recordings(swings(1), config); }), "never");
  config.phases = {"out: x < 5", "rest"};
  config.min_seconds = 0;
  const std::string message = refusal([&] {
    Recordings all = swings(1);
    all.all[0].phases.assign(201, "a");
    all.all[0].phases[200] = "b";
    cut_recordings(all, {});
  });
  EXPECT_PRED2(contains, message, "has 1 sample, at least 4");
}

}  // namespace
}  // namespace mocaplm::segment_test
