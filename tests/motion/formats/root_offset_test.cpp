// Programs that write the root's positions as relative to its OFFSET (iClone): its height is added
// where the figure would else walk that far under the floor, and nowhere else.
#include <gtest/gtest.h>

#include <algorithm>

#include "motion/formats/bvh.h"
#include "motion/formats/retarget.h"
#include "motion/synth.h"

namespace mocaplm::root_offset_test {
namespace {

// A dance on a Mixamo skeleton, whose root has a height in the rest pose.
Bvh dance() {
  SynthConfig config;
  config.seconds = 5;
  const Clip clip = make_dance(plan_dances(config).front(), config);
  return parse_bvh(bvh_text(clip, BvhUnit::centimetres, OutScheme::mixamo), "dance");
}

double& height(Bvh& bvh, Eigen::Index frame) {
  return bvh.values(frame, bvh.joints.front().first_channel + 1);
}

bool adds_offset(const Bvh& bvh, Clip* clip = nullptr) {
  RetargetReport report;
  const Clip read = retarget_bvh(bvh, "dance", {}, &report);
  if (clip != nullptr) *clip = read;
  return std::any_of(report.remarks.begin(), report.remarks.end(),
                     [](const Remark& remark) { return remark.kind == "root offset"; });
}

void expect_mended(const Bvh& right) {
  Bvh relative = right;
  for (Eigen::Index t = 0; t < right.frames(); ++t)
    height(relative, t) -= right.joints.front().offset.y();
  Clip truth, read;
  EXPECT_FALSE(adds_offset(right, &truth));
  EXPECT_TRUE(adds_offset(relative, &read));
  ASSERT_EQ(read.frames(), truth.frames());
  EXPECT_LT((read.trans - truth.trans).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((read.poses - truth.poses).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(RootOffset, IsAddedWhereTheFeetAreThatFarUnderTheFloor) {
  expect_mended(dance());
}

// A climber is at the bottom for a quarter of the time, and 60 cm up for the rest.
TEST(RootOffset, IsAddedForWhoClimbs) {
  Bvh bvh = dance();
  for (Eigen::Index t = bvh.frames() / 4; t < bvh.frames(); ++t) height(bvh, t) += 60;
  expect_mended(bvh);
}

TEST(RootOffset, IsNotAddedElsewhere) {
  Bvh jump = dance();  // off a wall, for a moment
  for (Eigen::Index t = 0; t < jump.frames() / 20; ++t) height(jump, t) -= 90;
  EXPECT_FALSE(adds_offset(jump));
  Bvh low = dance();  // a floor that lies 30 cm under zero
  for (Eigen::Index t = 0; t < low.frames(); ++t) height(low, t) -= 30;
  EXPECT_FALSE(adds_offset(low));
  Bvh deep = dance();  // the OFFSET would not bring it back
  for (Eigen::Index t = 0; t < deep.frames(); ++t) height(deep, t) -= 300;
  EXPECT_FALSE(adds_offset(deep));
}

}  // namespace
}  // namespace mocaplm::root_offset_test
