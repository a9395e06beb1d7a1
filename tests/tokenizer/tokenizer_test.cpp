#include "tokenizer/tokenizer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "motion/rotation.h"
#include "tests/tokenizer/random_clips.h"

namespace mocaplm::tokenizer_test {
namespace {

TokenizerConfig settings(std::int64_t bins, const std::string& root,
                         std::vector<std::string> joints = {"thesis"}) {
  TokenizerConfig config;
  config.bins = bins;
  config.root = root;
  config.joints = std::move(joints);
  return config;
}

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "(no error)";
}

TEST(Tokenizer, NamesItsChannels) {
  const Tokenizer tokenizer = Tokenizer::fit(settings(360, "steps"), {random_clip(1, 50)});
  EXPECT_EQ(tokenizer.channels(), 42);
  EXPECT_EQ(tokenizer.tokens_per_frame(), 43);
  EXPECT_EQ(tokenizer.rotation_channels(), 39);
  EXPECT_EQ(tokenizer.vocabulary(), 364);
  EXPECT_EQ(tokenizer.channel_name(0), "pelvis.x");
  EXPECT_EQ(tokenizer.channel_name(10), "left_knee.y");
  EXPECT_EQ(tokenizer.channel_name(39), "root.left");
  EXPECT_EQ(tokenizer.channel_name(40), "root.height");
  EXPECT_EQ(tokenizer.channel_name(41), "root.forward");
  EXPECT_EQ(tokenizer.channel_name(42), "separator");
  EXPECT_EQ(tokenizer.channel_joint(10), 4);
  EXPECT_EQ(tokenizer.channel_joint(40), -1);
  EXPECT_EQ(Tokenizer::fit(settings(9, "none", {"left_knee"}), {}).channels(), 3);
}

// Reference: 1.03/2.00, 0.50/1.00, 0.25/0.50, 0.125/0.25 degrees, a quarter and a half of a bin.
TEST(Tokenizer, RotationErrorIsAQuarterBinOnAverageAndHalfABinAtMost) {
  const Clip clip = random_clip(2, 3000);
  for (const int bins : {90, 180, 360, 720}) {
    const Tokenizer tokenizer = Tokenizer::fit(settings(bins, "none", {"all"}), {});
    const Eigen::MatrixXd values = tokenizer.channel_values(clip);
    const Clip back = tokenizer.decode(tokenizer.encode(clip).ids);
    const Eigen::MatrixXd error = (values - tokenizer.channel_values(back)).cwiseAbs() * 180 / kPi;
    EXPECT_NEAR(error.mean(), 90.0 / bins, 0.03 * 90.0 / bins) << bins;
    EXPECT_NEAR(error.maxCoeff(), 180.0 / bins, 0.01 * 180.0 / bins) << bins;
    EXPECT_LE(error.maxCoeff(), 180.0 / bins + 1e-9) << bins;
  }
}

TEST(Tokenizer, ChannelValuesAreTheSameRotationsAndContinuous) {
  const Clip clip = random_clip(3, 2000);
  const Tokenizer tokenizer = Tokenizer::fit(settings(360, "none"), {});
  const Eigen::MatrixXd values = tokenizer.channel_values(clip);
  EXPECT_LE(values.cwiseAbs().maxCoeff(), kPi);
  int jumps = 0, jumps_before = 0;
  for (int c = 0; c < tokenizer.rotation_channels(); c += 3) {
    for (Eigen::Index t = 0; t < values.rows(); ++t) {
      const Eigen::Vector3d source =
          clip.poses.row(t).segment<3>(3 * tokenizer.channel_joint(c)).transpose();
      const Eigen::Vector3d value = values.row(t).segment<3>(c).transpose();
      EXPECT_LT(
          geodesic_angle(quaternion_from_axis_angle(source), quaternion_from_axis_angle(value)),
          1e-7);
      if (t == 0) continue;
      jumps += (values.row(t) - values.row(t - 1)).segment<3>(c).norm() > 3;
      jumps_before += (clip.poses.row(t) - clip.poses.row(t - 1))
                          .segment<3>(3 * tokenizer.channel_joint(c))
                          .norm() > 3;
    }
  }
  EXPECT_LT(jumps, jumps_before / 2) << "made continuous where the range allows it";
}

TEST(Tokenizer, WhatItDecodedItEncodesBackToTheSameTokens) {
  std::vector<Clip> clips;
  for (std::uint64_t seed = 10; seed < 30; ++seed) clips.push_back(random_clip(seed, 150));
  for (const std::string root : {"steps", "absolute", "none"}) {
    for (const int bins : {7, 90, 360, 4096}) {
      const Tokenizer tokenizer = Tokenizer::fit(settings(bins, root), clips);
      for (const Clip& clip : clips) {
        const TokenStream stream = tokenizer.encode(clip);
        ASSERT_EQ(stream.size(), static_cast<std::size_t>(150 * tokenizer.tokens_per_frame()));
        const Clip back = tokenizer.decode(stream.ids, "x", clip.trans.row(0).transpose());
        EXPECT_EQ(back.fps, 20);
        EXPECT_TRUE(tokenizer.encode(back).ids == stream.ids) << root << " " << bins;
        EXPECT_EQ(tokenizer.from_text(tokenizer.to_text(stream.ids)), stream.ids);
        for (std::size_t i = 0; i < stream.size(); ++i) {
          ASSERT_EQ(stream.frame[i], static_cast<int>(i) / tokenizer.tokens_per_frame());
          ASSERT_EQ(stream.channel[i], static_cast<int>(i) % tokenizer.tokens_per_frame());
        }
      }
    }
  }
}

TEST(Tokenizer, StepsDoNotAddUpTheirRounding) {
  const Clip clip = random_clip(4, 6000);
  const Tokenizer tokenizer = Tokenizer::fit(settings(360, "steps"), {clip});
  EncodeReport report;
  const TokenStream stream = tokenizer.encode(clip, &report);
  EXPECT_EQ(report.values, 6000 * 42);
  const Clip back = tokenizer.decode(stream.ids, "", clip.trans.row(0).transpose());
  double bin = 0;
  for (const int c : {39, 41})
    bin = std::max(bin, tokenizer.bin_centre(c, 1) - tokenizer.bin_centre(c, 0));
  const double height_bin = tokenizer.bin_centre(40, 1) - tokenizer.bin_centre(40, 0);
  // Frames after a step that was cut to the range wait until the rest is caught up.
  Eigen::Index far = 0;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    EXPECT_LE(std::abs(clip.trans(t, 1) - back.trans(t, 1)), 0.5 * height_bin + 1e-9);
    const double error =
        std::hypot(clip.trans(t, 0) - back.trans(t, 0), clip.trans(t, 2) - back.trans(t, 2));
    far += error > bin * std::sqrt(0.5) + 1e-9;
  }
  EXPECT_LE(far, 10 * report.clamped);
  EXPECT_LT(report.clamped, 60);
  EXPECT_LE(std::hypot(clip.trans(5999, 0) - back.trans(5999, 0),
                       clip.trans(5999, 2) - back.trans(5999, 2)),
            bin);
}

TEST(Tokenizer, AJumpPastTheRangeIsCountedAndCaughtUp) {
  Clip clip = random_clip(5, 400);
  const Tokenizer tokenizer = Tokenizer::fit(settings(360, "steps"), {clip});
  for (Eigen::Index t = 200; t < 400; ++t) clip.trans(t, 0) += 1.0;  // a metre in one frame
  EncodeReport report;
  const Clip back =
      tokenizer.decode(tokenizer.encode(clip, &report).ids, "", clip.trans.row(0).transpose());
  EXPECT_GT(report.clamped, 0);
  EXPECT_GT(std::abs(clip.trans(200, 0) - back.trans(200, 0)), 0.1);
  EXPECT_LT((clip.trans.row(399) - back.trans.row(399)).norm(), 0.02);
}

TEST(Tokenizer, WhoStandsStillStaysExactly) {
  Clip clip = random_clip(6, 100);
  for (Eigen::Index t = 0; t < 100; ++t) clip.trans.row(t) = clip.trans.row(0);
  const Tokenizer tokenizer = Tokenizer::fit(settings(360, "steps"), {random_clip(7, 300)});
  const Clip back = tokenizer.decode(tokenizer.encode(clip).ids, "", clip.trans.row(0).transpose());
  for (Eigen::Index t = 0; t < 100; ++t)
    EXPECT_LT((back.trans.row(t) - back.trans.row(0)).norm(), 1e-9);
}

TEST(Tokenizer, ResamplesToItsOwnRate) {
  const Clip clip = random_clip(8, 601, 60);
  const Tokenizer tokenizer = Tokenizer::fit(settings(360, "steps"), {clip});
  EXPECT_EQ(tokenizer.channel_values(clip).rows(), 201);
  Clip wrong = clip;
  wrong.fps = 1e-5;
  EXPECT_NE(error_of([&] { tokenizer.encode(wrong); }).find("is the rate right?"),
            std::string::npos);
}

TEST(Tokenizer, CountsNothingOutsideTheRotationsRange) {
  Clip clip = random_clip(9, 200);
  clip.poses *= 7;  // many turns: the same rotations have vectors inside the range
  EncodeReport report;
  Tokenizer::fit(settings(360, "none"), {}).encode(clip, &report);
  EXPECT_EQ(report.clamped, 0);
}

TEST(Tokenizer, RefusesStreamsThatAreNotWholeFrames) {
  const Tokenizer tokenizer = Tokenizer::fit(settings(360, "none", {"pelvis", "left_knee"}), {});
  const std::vector<std::int32_t> good = tokenizer.encode(random_clip(1, 3)).ids;
  const auto refused = [&](std::vector<std::int32_t> ids) {
    return error_of([&] { tokenizer.decode(ids, "s"); });
  };
  EXPECT_NE(refused({}).find("no tokens"), std::string::npos);
  std::vector<std::int32_t> bad = good;
  bad.pop_back();
  EXPECT_NE(refused(bad).find("s: frame 2, separator: found the end"), std::string::npos)
      << refused(bad);
  bad = good;
  bad[7 + 4] = Tokenizer::kMask;
  EXPECT_NE(refused(bad).find("frame 1, left_knee.y: found the mask token"), std::string::npos)
      << refused(bad);
  bad = good;
  bad.insert(bad.begin() + 2, bad[2]);
  EXPECT_NE(refused(bad).find("frame 0, separator: found bin"), std::string::npos) << refused(bad);
  bad = good;
  bad[0] = 364;
  EXPECT_NE(refused(bad).find("frame 0, pelvis.x: found unknown token 364"), std::string::npos);
  bad[0] = -1;
  EXPECT_NE(refused(bad).find("unknown token -1"), std::string::npos);
}

TEST(Tokenizer, RefusesSettingsAndClipsThatCannotBe) {
  EXPECT_THROW(Tokenizer::fit(settings(1, "none"), {}), Error);
  EXPECT_THROW(Tokenizer::fit(settings(5000, "none"), {}), Error);
  EXPECT_THROW(Tokenizer::fit(settings(360, "sideways"), {}), Error);
  EXPECT_THROW(Tokenizer::fit(settings(360, "none", {"left_kneee"}), {}), UsageError);
  EXPECT_THROW(Tokenizer::fit(settings(360, "none", {}), {}), UsageError);
  EXPECT_THROW(Tokenizer::fit(settings(360, "steps"), {}), UsageError);
  Clip clip = random_clip(1, 10);
  clip.poses(3, 5) = std::nan("");
  EXPECT_THROW(Tokenizer::fit(settings(360, "steps"), {clip}), DataError);
}

}  // namespace
}  // namespace mocaplm::tokenizer_test
