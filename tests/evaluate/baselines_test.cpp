#include "evaluate/baselines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "common/error.h"
#include "common/random.h"
#include "tests/tokenizer/random_clips.h"

namespace mocaplm::baselines_test {
namespace {

BinMatrix random_bins(std::uint64_t seed, Eigen::Index frames, Eigen::Index channels, int bins) {
  Random random(seed);
  BinMatrix matrix(frames, channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    int x = static_cast<int>(random.below(static_cast<std::uint64_t>(bins)));
    for (Eigen::Index t = 0; t < frames; ++t) {
      matrix(t, c) = x;
      x = (x + bins + static_cast<int>(random.below(5)) - 2) % bins;
    }
  }
  return matrix;
}

// The definition with maps, one channel at a time.
double slow_bits(const std::vector<BinMatrix>& train, const BinMatrix& test, int order, int bins,
                 double smoothing, int skip) {
  const auto code = [&](const BinMatrix& x, Eigen::Index t, Eigen::Index c, int k) {
    long value = x(t, c);
    if (k == 1) value -= x(t - 1, c);
    if (k == 2) value -= 2L * x(t - 1, c) - x(t - 2, c);
    return ((value % bins) + bins) % bins;
  };
  double sum = 0;
  for (Eigen::Index c = 0; c < test.cols(); ++c) {
    std::map<long, double> counts[3];
    double totals[3] = {0, 0, 0};
    for (const BinMatrix& clip : train)
      for (int k = 0; k < 3; ++k)
        for (Eigen::Index t = k; t < clip.rows(); ++t) {
          counts[k][code(clip, t, c, k)] += 1;
          totals[k] += 1;
        }
    for (Eigen::Index t = skip; t < test.rows(); ++t) {
      const int k = std::min(order, static_cast<int>(t));
      sum -=
          std::log2((counts[k][code(test, t, c, k)] + smoothing) / (totals[k] + smoothing * bins));
    }
  }
  return sum;
}

TEST(Baselines, AgreeWithTheDefinitionWrittenOut) {
  const std::vector<BinMatrix> train = {random_bins(1, 60, 4, 17), random_bins(2, 1, 4, 17),
                                        random_bins(3, 2, 4, 17)};
  const BinMatrix test = random_bins(4, 40, 4, 17);
  for (const double smoothing : {1.0, 0.25}) {
    Baselines baselines(4, 17, smoothing);
    for (const BinMatrix& clip : train) baselines.add(clip);
    for (int order = 0; order < 3; ++order) {
      const BitCount all = baselines.score(order, test),
                     predicted = baselines.score(order, test, true);
      EXPECT_EQ(all.frames, 40);
      EXPECT_EQ(predicted.frames, 38);
      EXPECT_NEAR(all.per_frame() * 40, slow_bits(train, test, order, 17, smoothing, 0), 1e-9);
      EXPECT_NEAR(predicted.per_frame() * 38, slow_bits(train, test, order, 17, smoothing, 2),
                  1e-9);
      EXPECT_NEAR(all.per_frame(0, 1) + all.per_frame(1, 3), all.per_frame(), 1e-12);
    }
  }
}

TEST(Baselines, KnowNothingBeforeTraining) {
  const BinMatrix test = random_bins(5, 10, 3, 360);
  for (int order = 0; order < 3; ++order)
    EXPECT_NEAR(Baselines(3, 360).score(order, test).per_frame(), 3 * std::log2(360), 1e-9);
}

TEST(Baselines, EachOrderFindsItsOwnRegularity) {
  BinMatrix constant(1000, 1), line(1000, 1);
  for (int t = 0; t < 1000; ++t) {
    constant(t, 0) = 7;
    line(t, 0) = 3 * t % 360;
  }
  Baselines still(1, 360), moving(1, 360);
  still.add(constant);
  moving.add(line);
  EXPECT_LT(still.score(0, constant).per_frame(), 0.5);
  EXPECT_GT(moving.score(0, line).per_frame(), 6);
  EXPECT_LT(moving.score(1, line).per_frame(), 0.5);
  EXPECT_LT(moving.score(2, line).per_frame(), 0.5);
}

TEST(Baselines, ShortClipsAreScoredWithWhatTheyHave) {
  Baselines baselines(2, 10);
  baselines.add(random_bins(6, 50, 2, 10));
  const BinMatrix one = random_bins(7, 1, 2, 10);
  EXPECT_EQ(baselines.score(2, one).per_frame(), baselines.score(0, one).per_frame());
  EXPECT_EQ(baselines.score(2, one, true).frames, 0);
  EXPECT_EQ(baselines.score(2, one, true).per_frame(), 0);
  BitCount sum;
  sum.add(baselines.score(1, one));
  sum.add(baselines.score(1, one));
  EXPECT_EQ(sum.frames, 2);
  EXPECT_DOUBLE_EQ(sum.per_frame(), baselines.score(1, one).per_frame());
}

TEST(Baselines, ReadTheBinsOfATokenStream) {
  TokenizerConfig config;
  config.joints = {"pelvis", "left_knee"};
  const Clip clip = random_clip(8, 25);
  const Tokenizer tokenizer = Tokenizer::fit(config, {clip});
  const TokenStream stream = tokenizer.encode(clip);
  const BinMatrix bins = stream_bins(tokenizer, stream.ids);
  ASSERT_EQ(bins.rows(), 25);
  ASSERT_EQ(bins.cols(), 9);
  for (std::size_t i = 0; i < stream.size(); ++i)
    if (stream.channel[i] < 9) {
      EXPECT_EQ(bins(stream.frame[i], stream.channel[i]), stream.ids[i] - Tokenizer::kFirstBin);
    }
  std::vector<std::int32_t> bad = stream.ids;
  bad[12] = Tokenizer::kSeparator;
  EXPECT_THROW(stream_bins(tokenizer, bad), DataError);
}

}  // namespace
}  // namespace mocaplm::baselines_test
