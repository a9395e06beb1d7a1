#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/refusal.h"
#include "tests/tokenizer/random_clips.h"
#include "tokenizer/measure.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm::quantile_tokenizer_test {
namespace {

std::vector<Clip> some_clips() {
  std::vector<Clip> clips;
  for (std::uint64_t seed = 40; seed < 50; ++seed) clips.push_back(random_clip(seed, 300));
  return clips;
}

TokenizerConfig settings(const std::string& binning, std::int64_t bins = 360,
                         const std::string& root = "steps") {
  TokenizerConfig config;
  config.binning = binning;
  config.bins = bins;
  config.root = root;
  return config;
}

TEST(QuantileTokenizer, EachBinIsUsedEquallyOften) {
  const std::vector<Clip> clips = some_clips();
  const Tokenizer tokenizer = Tokenizer::fit(settings("quantile", 30, "none"), clips);
  std::vector<std::vector<int>> filled(39, std::vector<int>(30));
  for (const Clip& clip : clips) {
    const TokenStream stream = tokenizer.encode(clip);
    for (std::size_t i = 0; i < stream.size(); ++i)
      if (stream.channel[i] < 39)
        ++filled[static_cast<std::size_t>(stream.channel[i])]
                [static_cast<std::size_t>(stream.ids[i] - Tokenizer::kFirstBin)];
  }
  for (const auto& bins : filled)
    for (const int count : bins) EXPECT_NEAR(count, 100, 1);
}

TEST(QuantileTokenizer, PooledBinsAreTheSameForAllRotations) {
  const Tokenizer tokenizer = Tokenizer::fit(settings("pooled_quantile"), some_clips());
  for (int c = 1; c < 39; ++c)
    for (const int bin : {0, 100, 359})
      EXPECT_EQ(tokenizer.bin_centre(c, bin), tokenizer.bin_centre(0, bin));
  EXPECT_NE(tokenizer.bin_centre(39, 100), tokenizer.bin_centre(0, 100));
  EXPECT_NE(tokenizer.bin_centre(39, 100), tokenizer.bin_centre(40, 100));
}

TEST(QuantileTokenizer, WhatItDecodedItEncodesBackToTheSameTokens) {
  const std::vector<Clip> clips = some_clips();
  for (const std::string binning : {"quantile", "pooled_quantile"})
    for (const std::string root : {"steps", "absolute", "none"})
      for (const int bins : {2, 90, 4096}) {
        const Tokenizer tokenizer = Tokenizer::fit(settings(binning, bins, root), clips);
        for (const Clip& clip : {clips[0], random_clip(77, 200)}) {
          const TokenStream stream = tokenizer.encode(clip);
          const Clip back = tokenizer.decode(stream.ids, "x", clip.trans.row(0).transpose());
          EXPECT_TRUE(tokenizer.encode(back).ids == stream.ids) << binning << root << bins;
          EXPECT_EQ(tokenizer.from_text(tokenizer.to_text(stream.ids)), stream.ids);
        }
      }
}

TEST(QuantileTokenizer, LosesLessThanUniformBinsOnTheWhole) {
  const std::vector<Clip> clips = some_clips();
  double mean[2];
  for (const bool quantile : {false, true}) {
    const Tokenizer tokenizer =
        Tokenizer::fit(settings(quantile ? "quantile" : "uniform", 90, "none"), clips);
    TokenizerLoss loss;
    for (const Clip& clip : clips) encode_and_measure(tokenizer, clip, loss);
    mean[quantile] = loss.component_sum / static_cast<double>(loss.components);
  }
  EXPECT_LT(mean[1], mean[0]);
}

TEST(QuantileTokenizer, WhoStandsStillStaysExactly) {
  Clip clip = random_clip(6, 100);
  for (Eigen::Index t = 0; t < 100; ++t) clip.trans.row(t) = clip.trans.row(0);
  const Tokenizer tokenizer = Tokenizer::fit(settings("quantile"), some_clips());
  const Clip back = tokenizer.decode(tokenizer.encode(clip).ids, "", clip.trans.row(0).transpose());
  for (Eigen::Index t = 0; t < 100; ++t)
    EXPECT_LT((back.trans.row(t) - back.trans.row(0)).norm(), 1e-9);
}

TEST(QuantileTokenizer, AJointThatNeverMovesHasOneBinAndItIsSaid) {
  std::vector<Clip> clips = some_clips();
  for (Clip& clip : clips) clip.poses.middleCols<3>(3 * 4).setConstant(0.25);  // the left knee
  const Tokenizer tokenizer = Tokenizer::fit(settings("quantile"), clips);
  EXPECT_EQ(tokenizer.channel_bins(9), 1);
  EXPECT_EQ(tokenizer.channel_bins(0), 360);
  EXPECT_EQ(tokenizer.bin_centre(9, 0), 0.25);
  EXPECT_EQ(tokenizer.bin_centre(9, 359), 0.25) << "a model may say any bin";
  TokenizerLoss loss;
  encode_and_measure(tokenizer, clips[0], loss);
  EXPECT_PRED2(contains, loss.table(tokenizer).text(), "3 channels have fewer bins (1 the fewest)");
  const Tokenizer back = Tokenizer::from_json(tokenizer.to_json(), "t");
  EXPECT_EQ(back.channel_bins(9), 1);
}

// A pose that no fitted clip shows becomes the outermost bin, and it is said how many values that
// were and how far they lay outside.
TEST(QuantileTokenizer, PosesBeyondTheFittedOnesAreBoundedAndCounted) {
  std::vector<Clip> clips = some_clips();
  for (Clip& clip : clips)  // the left knee bends between 0.1 and 0.5 about x
    for (Eigen::Index t = 0; t < clip.frames(); ++t)
      clip.poses.row(t).segment<3>(12) << 0.3 + 0.2 * std::sin(0.1 * static_cast<double>(t)), 0, 0;
  double low = 9, high = -9;
  for (const Clip& clip : clips) {
    low = std::min(low, clip.poses.col(12).minCoeff());
    high = std::max(high, clip.poses.col(12).maxCoeff());
  }
  for (const bool from_file : {false, true}) {
    Tokenizer tokenizer = Tokenizer::fit(settings("quantile", 90, "none"), clips);
    if (from_file) tokenizer = Tokenizer::from_json(tokenizer.to_json(), "t");
    TokenizerLoss known;
    for (const Clip& clip : clips) encode_and_measure(tokenizer, clip, known);
    EXPECT_EQ(known.encoded.clamped, 0);
    EXPECT_EQ(known.encoded.farthest_rotation, 0);

    Clip strange = clips[0];
    double farthest = 0;
    std::int64_t outside = 0;
    for (Eigen::Index t = 0; t < strange.frames(); ++t) {
      const double bend = -0.4 + 0.007 * static_cast<double>(t);  // -0.4 to 1.7
      strange.poses(t, 12) = bend;
      const double beyond = std::max({low - bend, bend - high, 0.0});
      farthest = std::max(farthest, beyond);
      outside += beyond > 0;
    }
    ASSERT_GT(outside, 100);
    TokenizerLoss loss;
    const TokenStream stream = encode_and_measure(tokenizer, strange, loss);
    EXPECT_EQ(loss.encoded.clamped, outside);
    EXPECT_NEAR(loss.encoded.farthest_rotation, farthest, 1e-12);
    // No pose is decoded to what was never seen, and the error is the distance and a bin.
    const Clip back = tokenizer.decode(stream.ids, "x", strange.trans.row(0).transpose());
    EXPECT_GE(back.poses.col(12).minCoeff(), low);
    EXPECT_LE(back.poses.col(12).maxCoeff(), high);
    EXPECT_LT(loss.component_max, (farthest + 0.02) * 180 / 3.14159);
    const std::string table = loss.table(tokenizer).text();
    EXPECT_PRED2(contains, table, "clamped values");
    EXPECT_PRED2(contains, table, "farthest outside, rotations");
  }
  // A file from before the range was kept: the outermost bins' values stand for it.
  const Tokenizer tokenizer = Tokenizer::fit(settings("quantile", 90), clips);
  Json old = tokenizer.to_json();
  for (auto& item : old["quantile_bins"].items()) item.value().erase("range");
  EXPECT_EQ(Tokenizer::from_json(old, "t").fingerprint(), tokenizer.fingerprint());
  EXPECT_NEAR(Tokenizer::from_json(old, "t").beyond(9, 1), 1 - tokenizer.bin_centre(9, 89), 1e-12);
}

TEST(QuantileTokenizer, JsonGoesThereAndBackExactly) {
  const std::vector<Clip> clips = some_clips();
  std::set<std::string> prints;
  for (const std::string binning : {"uniform", "quantile", "pooled_quantile"})
    for (const std::string root : {"steps", "none"}) {
      const Tokenizer tokenizer = Tokenizer::fit(settings(binning, 50, root), clips);
      const Json json = parse_json(tokenizer.to_json().dump(), "t");
      EXPECT_EQ(json.contains("quantile_bins"), binning != "uniform");
      EXPECT_EQ(json["settings"].contains("binning"), binning != "uniform");
      const Tokenizer back = Tokenizer::from_json(json, "t");
      EXPECT_EQ(back.fingerprint(), tokenizer.fingerprint());
      EXPECT_EQ(back.encode(clips[0]).ids, tokenizer.encode(clips[0]).ids);
      prints.insert(back.fingerprint());
    }
  EXPECT_EQ(prints.size(), 6u);
}

TEST(QuantileTokenizer, RefusesFilesThatAreNotWhole) {
  const Json good = Tokenizer::fit(settings("quantile", 20), some_clips()).to_json();
  const auto says = [&](const std::string& part, const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad);
    EXPECT_PRED2(contains, refusal([&] { Tokenizer::from_json(bad, "t.json"); }), part);
  };
  says("\"quantile_bins\": missing", [](Json& j) { j.erase("quantile_bins"); });
  says("\"left_knee.x\": missing", [](Json& j) { j["quantile_bins"].erase("left_knee.x"); });
  says("unknown key",
       [](Json& j) { j["quantile_bins"]["tail"] = j["quantile_bins"]["root.left"]; });
  says("changed by hand", [](Json& j) { j["settings"].erase("binning"); });
  says("changed by hand", [](Json& j) {
    auto& centre = j["quantile_bins"]["left_knee.x"]["centres"][3];
    centre = centre.get<double>() + 1e-7;
  });
  EXPECT_THROW(Tokenizer::fit(settings("quantile", 360, "none"), {}), UsageError);
}

// Old files: the fingerprint of uniform bins over these ranges, as first published.
TEST(QuantileTokenizer, UniformFingerprintsStay) {
  EXPECT_EQ(Tokenizer::fit(settings("uniform", 360, "none"), {}).fingerprint(), "7c61a35efbefbd80");
}

}  // namespace
}  // namespace mocaplm::quantile_tokenizer_test
