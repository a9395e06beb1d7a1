#include "spectral/features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

#include "common/angles.h"
#include "common/error.h"
#include "common/random.h"
#include "support/refusal.h"

namespace mocaplm::features_test {
namespace {

Series noise(Eigen::Index frames, Eigen::Index channels, std::uint64_t seed) {
  Random random(seed);
  Series series(frames, channels);
  for (Eigen::Index i = 0; i < series.size(); ++i)
    series.data()[i] = static_cast<float>(random.normal());
  return series;
}

std::vector<Series> windows(std::size_t count, Eigen::Index frames, Eigen::Index channels) {
  std::vector<Series> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(noise(frames, channels, 100 + i));
  return all;
}

TEST(Features, ThesisSizes) {
  EXPECT_EQ(FeatureMaker({}, 72).dimensions(), 15 * 9 * 72);
  SpectralConfig config;
  config.stft_window = 32;
  config.stft_hop = 16;
  EXPECT_EQ(FeatureMaker(config, 72).dimensions(), 7 * 17 * 72);
  config.feature = "dct";
  EXPECT_EQ(FeatureMaker(config, 72).dimensions(), 16 * 72);
}

TEST(Features, StftIsThePlainSum) {
  const Series window = noise(128, 2, 7);
  const Series row = FeatureMaker({}, 2).rows({window});
  const auto value = [&](Eigen::Index frame, Eigen::Index k, Eigen::Index c) {
    std::complex<double> sum = 0;
    for (Eigen::Index t = 0; t < 16; ++t)
      sum += window(8 * frame + t, c) * 0.5 * (1 - std::cos(2 * kPi * double(t) / 16)) *
             std::exp(std::complex<double>(0, -2 * kPi * double(k * t) / 16));
    return std::abs(sum);
  };
  for (const Eigen::Index f : {0, 7, 14})
    for (const Eigen::Index k : {0, 3, 8})
      for (const Eigen::Index c : {0, 1})
        EXPECT_NEAR(row(0, c * 135 + f * 9 + k), value(f, k, c), 1e-4);
}

TEST(Features, DctIsThePlainSum) {
  SpectralConfig config;
  config.feature = "dct";
  const Series window = noise(128, 3, 8);
  const Series row = FeatureMaker(config, 3).rows({window});
  ASSERT_EQ(row.cols(), 48);
  for (Eigen::Index c = 0; c < 3; ++c)
    for (Eigen::Index k = 0; k < 16; ++k) {
      double sum = 0;
      for (Eigen::Index t = 0; t < 128; ++t)
        sum += window(t, c) * std::cos(kPi * (double(t) + 0.5) * double(k) / 128);
      EXPECT_NEAR(row(0, c * 16 + k), sum * std::sqrt((k == 0 ? 1.0 : 2.0) / 128), 1e-4);
    }
}

// All components keep distances, the first ones keep most of what they can.
TEST(Features, ComponentsKeepDistances) {
  SpectralConfig config;
  config.window = 12;
  config.feature = "pca";
  config.coefficients = 12;
  const std::vector<Series> some = windows(30, 12, 3);
  FeatureMaker maker(config, 3);
  maker.fit(some);
  const Series rows = maker.rows(some);
  for (std::size_t i = 1; i < 5; ++i)
    EXPECT_NEAR((rows.row(Eigen::Index(i)) - rows.row(0)).norm(), (some[i] - some[0]).norm(), 1e-3);
  config.feature = "pose";
  config.reduce = 36;
  FeatureMaker whole(config, 3);
  EXPECT_TRUE(whole.needs_fit());
  whole.fit(some);
  const Series reduced = whole.rows(some);
  ASSERT_EQ(reduced.cols(), 36);
  EXPECT_NEAR((reduced.row(3) - reduced.row(9)).norm(), (some[3] - some[9]).norm(), 1e-3);
  EXPECT_LT(reduced.colwise().mean().norm(), 1e-4f);
}

TEST(Features, ConstantChannelsAreFine) {
  SpectralConfig config;
  config.window = 16;
  config.coefficients = 4;
  for (const char* feature : {"stft", "dct", "pca", "pose"})
    for (const std::int64_t reduce : {0, 3}) {
      config.feature = feature;
      config.reduce = reduce;
      FeatureMaker maker(config, 3);
      const std::vector<Series> still = {Series::Zero(16, 3), Series::Constant(16, 3, 0.5f)};
      if (maker.needs_fit()) maker.fit(still);
      EXPECT_TRUE(maker.rows(still).allFinite()) << feature << reduce;
    }
}

TEST(Features, RefuseWhatCannotBe) {
  SpectralConfig config;
  config.window = 16;
  config.reduce = 500;
  EXPECT_TRUE(contains(refusal<UsageError>([&] { FeatureMaker(config, 3); }), "500"));
  config.reduce = 2;
  FeatureMaker maker(config, 3);
  EXPECT_TRUE(contains(refusal([&] { maker.fit({}); }), "no windows"));
  std::vector<Series> bad = windows(3, 16, 3);
  bad[1](2, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(contains(refusal([&] { maker.fit(bad); }), "finite"));
  EXPECT_TRUE(contains(refusal([&] { maker.set_learned({}, "x.index"); }), "x.index"));
}

}  // namespace
}  // namespace mocaplm::features_test
