// Clips with filled gaps: what is known stays, paths meet, lines are lines.
#include "infill/infill.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/temporary_folder.h"
#include "model/directory.h"
#include "model/transformer/weights.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "support/refusal.h"
#include "support/small_models.h"
#include "tokenizer/random_clips.h"
#include "tokenizer/tokenizer.h"
#include "train/stream_shape.h"

namespace mocaplm::infill_test {
namespace {

class Infill : public testing::Test {
 protected:
  void SetUp() override {
    TokenizerConfig config;
    config.bins = 60;
    config.joints = {"root", "left_arm"};
    const Tokenizer tokenizer = Tokenizer::fit(config, {random_clip(1, 60), random_clip(2, 60)});
    StoredModel stored;
    stored.description = small_description();
    stored.description.config.objective = "masked";
    stored.description.config.block_size = 16 * 6;
    stored.description.shape = stream_shape(tokenizer);
    stored.description.tokenizer_fingerprint = tokenizer.fingerprint();
    stored.tokenizer = tokenizer.to_json();
    stored.tensors = random_weights(stored.description, 3);
    save_model(folder_ / "masked", stored);
    stored.description.config.objective = "causal";
    save_model(folder_ / "causal", stored);
    options_.model = folder_ / "masked";
    options_.clip = random_clip(4, 40);
    options_.device = "cpu";
    options_.precision = "f32";
    options_.threads = 1;
    options_.fill.rounds = 3;
  }
  TemporaryFolder folder_;
  InfillOptions options_;
};

TEST_F(Infill, JointsAreFilledAndAllElseStays) {
  options_.joints = {16, 18};
  options_.from = 0.5;
  options_.to = 1;
  const InfillResult r = infill(options_);
  EXPECT_EQ(r.first, 10);
  EXPECT_EQ(r.last, 20);
  EXPECT_EQ(r.tokens, 10 * 6);
  EXPECT_TRUE(r.filled.trans == r.original.trans);
  for (Eigen::Index t = 0; t < 40; ++t)
    for (int j = 0; j < kJoints; ++j) {
      const bool missing = t >= 10 && t < 20 && (j == 16 || j == 18);
      const bool same =
          r.filled.poses.row(t).segment<3>(3 * j) == r.original.poses.row(t).segment<3>(3 * j);
      EXPECT_EQ(same, !missing) << t << " " << j;
    }
  EXPECT_GT(r.error.mean, 0);
  EXPECT_GE(r.error.most, r.error.mean);
  ASSERT_TRUE(r.line);
  EXPECT_LT(r.bins.mean, 6);  // 60 bins: 6 degrees each
}

TEST_F(Infill, FramesAreFilledAndThePathMeets) {
  const std::vector<std::pair<double, double>> gaps = {{0.5, 1.0}, {0.0, 0.4}, {1.5, 0.0}};
  for (const auto& [from, to] : gaps) {
    options_.from = from;
    options_.to = to;
    const InfillResult r = infill(options_);
    EXPECT_EQ(r.tokens, (r.last - r.first) * 15);
    for (Eigen::Index t = 0; t < 40; ++t) {
      if (t >= r.first && t < r.last) continue;
      EXPECT_TRUE(r.filled.poses.row(t) == r.original.poses.row(t)) << t;
      EXPECT_TRUE(r.filled.trans.row(t) == r.original.trans.row(t)) << t;
    }
    check_clip(r.filled, "filled");
    EXPECT_TRUE(r.line);
  }
}

TEST_F(Infill, JointsMayBeMissingThroughout) {
  options_.joints = {18};
  const InfillResult r = infill(options_);
  EXPECT_EQ(r.first, 0);
  EXPECT_EQ(r.last, 40);
  EXPECT_FALSE(r.line);
}

TEST_F(Infill, WhatCannotBeIsRefused) {
  const auto refused = [&] { return refusal<UsageError>([&] { infill(options_); }); };
  EXPECT_TRUE(contains(refused(), "nothing of the clip is known"));
  options_.joints = {5};
  EXPECT_TRUE(contains(refused(), "right_knee"));
  options_.joints = {0};
  options_.from = 3;
  EXPECT_TRUE(contains(refused(), "nothing is missing"));
  options_.from = 0;
  options_.labels = {{"genre", "waack"}};
  EXPECT_TRUE(contains(refused(), "genre"));
  options_.labels.clear();
  options_.model = folder_ / "causal";
  EXPECT_TRUE(contains(refused(), "--objective masked"));
}

TEST(Bridged, IsALineBetweenTheFramesAround) {
  Clip clip = random_clip(5, 12);
  const Clip line = bridged(clip, 4, 9);
  for (Eigen::Index t = 4; t < 9; ++t) {
    const double share = static_cast<double>(t - 3) / 6;
    EXPECT_LT(
        (line.trans.row(t) - (1 - share) * clip.trans.row(3) - share * clip.trans.row(9)).norm(),
        1e-12);
    for (int j = 0; j < kJoints; ++j) {
      const auto at = [&](const Clip& c, Eigen::Index frame) {
        return quaternion_from_axis_angle(c.poses.row(frame).segment<3>(3 * j).transpose());
      };
      const double whole = geodesic_angle(at(clip, 3), at(clip, 9));
      EXPECT_NEAR(geodesic_angle(at(clip, 3), at(line, t)), share * whole, 1e-6);
      EXPECT_NEAR(geodesic_angle(at(line, t), at(clip, 9)), (1 - share) * whole, 1e-6);
    }
  }
  const Clip held = bridged(clip, 0, 3), rest = bridged(clip, 10, 12);
  EXPECT_LT((held.trans.row(1) - clip.trans.row(3)).norm(), 1e-12);
  EXPECT_LT((rest.trans.row(11) - clip.trans.row(9)).norm(), 1e-12);
  EXPECT_NEAR(fill_error(held, clip, {2}, 3, 12).most, 0, 1e-5);
}

}  // namespace
}  // namespace mocaplm::infill_test
