#include "spectral/filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "motion/rotation.h"
#include "numeric/dct.h"
#include "spectral/embedding.h"
#include "spectral/measures.h"
#include "support/refusal.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::filter_test {
namespace {

// A head that nods at `slow` Hz and trembles at `fast` Hz, on whole coefficients of the DCT.
Clip nodding(Eigen::Index frames, double fps, int slow, int fast) {
  Clip clip;
  clip.name = "nod";
  clip.fps = fps;
  clip.poses = Poses::Zero(frames, 72);
  clip.trans = Translations::Zero(frames, 3);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const double at = kPi * (double(t) + 0.5) / double(frames);
    clip.poses(t, 45) = 0.3 + 0.4 * std::cos(at * slow) + 0.05 * std::cos(at * fast);
    clip.trans(t, 0) = 1 + std::cos(at * slow);
  }
  return clip;
}

FilterConfig filter_config(const char* keep, double from, double to) {
  FilterConfig config;
  config.keep = keep;
  config.from_hz = from;
  config.to_hz = to;
  return config;
}

TEST(Filter, KeepsTheFrequenciesAsked) {
  // 60 frames at 30 fps: coefficient k has k / 4 Hz; 4 is 1 Hz, 40 is 10 Hz.
  const Clip clip = nodding(60, 30, 4, 40);
  const FilterResult low = filter_clip(clip, filter_config("low", 0, 2));
  const FilterResult band = filter_clip(clip, filter_config("band", 8, 12));
  const FilterResult border = filter_clip(clip, filter_config("band", 10, 10.1));
  EXPECT_EQ(low.first, 1);
  EXPECT_EQ(low.last, 9);
  for (Eigen::Index t = 0; t < 60; ++t) {
    const double at = kPi * (double(t) + 0.5) / 60;
    EXPECT_NEAR(low.filtered.poses(t, 45), 0.3 + 0.4 * std::cos(4 * at), 1e-12);
    EXPECT_NEAR(low.filtered.trans(t, 0), 1 + std::cos(4 * at), 1e-12);
    EXPECT_NEAR(band.filtered.poses(t, 45), 0.3 + 0.05 * std::cos(40 * at), 1e-12);
    EXPECT_NEAR(band.filtered.trans(t, 0), 1, 1e-12);
    EXPECT_NEAR(border.filtered.poses(t, 45), band.filtered.poses(t, 45), 1e-12);
  }
  EXPECT_NEAR(low.kept_share, 0.16 / (0.16 + 0.0025), 1e-9);
  EXPECT_NEAR(fast_share(clip), 0.0025 / (0.16 + 0.0025), 1e-9);
  EXPECT_NEAR(fast_share(low.filtered), 0, 1e-12);
  // A nodding head moves no joint; a body that moves all its joints gets smoother.
  const Clip all = random_clip(4, 300, 60);
  EXPECT_LT(roughness(filter_clip(all, filter_config("low", 0, 5)).filtered), 0.2 * roughness(all));
}

TEST(Filter, AllFrequenciesGiveTheMotionBack) {
  const Clip clip = random_clip(5, 300, 60);
  const FilterResult all = filter_clip(clip, filter_config("low", 0, 30));
  const AngleApart apart = angle_apart(clip, all.filtered);
  EXPECT_LT(apart.most, 1e-5);
  EXPECT_LT((clip.trans - all.filtered.trans).norm(), 1e-9);
  EXPECT_NEAR(all.kept_share, 1, 1e-9);
  check_clip(all.filtered, "filtered");
}

// A dancer who spins, stored in [-pi, pi]: filtered, it still spins.
TEST(Filter, SpinsAreNoJumps) {
  Clip clip = nodding(200, 50, 4, 5);
  for (Eigen::Index t = 0; t < 200; ++t)
    clip.poses.row(t).segment<3>(0) =
        axis_angle_from_quaternion(
            quaternion_from_axis_angle(Eigen::Vector3d(0, 0.1 * double(t), 0)))
            .transpose();
  const Clip slow = filter_clip(clip, filter_config("low", 0, 3)).filtered;
  for (Eigen::Index t = 20; t < 180; ++t)
    EXPECT_LT(
        geodesic_angle(quaternion_from_axis_angle(slow.poses.row(t).segment<3>(0).transpose()),
                       quaternion_from_axis_angle(clip.poses.row(t).segment<3>(0).transpose())),
        0.1);
  EXPECT_LE(slow.poses.cwiseAbs().maxCoeff(), kPi + 1e-9);
}

TEST(Filter, BadInputIsAnswered) {
  EXPECT_TRUE(contains(refusal([] { filter_clip(random_clip(1, 1), filter_config("low", 0, 3)); }),
                       "one frame"));
  const Clip clip = random_clip(1, 40, 20);
  const auto told = [&](const FilterConfig& config) {
    return refusal<UsageError>([&] { filter_clip(clip, config); });
  };
  EXPECT_TRUE(contains(told(filter_config("band", 3, 3)), "from_hz"));
  EXPECT_TRUE(contains(told(filter_config("low", 0, 0.1)), "0.250 Hz"));
  EXPECT_TRUE(contains(told(filter_config("band", 11, 12)), "up to 10"));
  Clip still = clip;
  still.poses.rowwise() = clip.poses.row(0).eval();
  still.trans.setZero();
  const FilterResult same = filter_clip(still, filter_config("low", 0, 3));
  EXPECT_LT(angle_apart(still, same.filtered).most, 1e-5);
  EXPECT_EQ(same.kept_share, 1);
  filter_table(still, same, filter_config("low", 0, 3));
}

TEST(Measures, RoughnessIsTheThirdDifference) {
  EXPECT_EQ(roughness(random_clip(1, 3)), 0);
  Clip still = random_clip(2, 20, 30);
  still.poses.rowwise() = still.poses.row(0).eval();
  EXPECT_NEAR(roughness(still), 0, 1e-6);
  // Slower by two: an eighth.
  Clip clip = nodding(60, 60, 4, 30);
  const double fast = roughness(clip);
  clip.fps = 30;
  EXPECT_NEAR(roughness(clip), fast / 8, 1e-9 * fast);
}

TEST(Embedding, OneChannelIsItsOwnSpectrum) {
  Series one = Series::Zero(64, 3);
  for (Eigen::Index t = 0; t < 64; ++t) one(t, 1) = float(std::cos(2 * kPi * double(t) / 4));
  const std::vector<Eigen::MatrixXd> found = stft_embeddings({one, 2 * one}, 16, 8);
  ASSERT_EQ(found.size(), 2u);
  ASSERT_EQ(found[0].rows(), 9);
  ASSERT_EQ(found[0].cols(), 7);
  for (Eigen::Index f = 0; f < 7; ++f) {
    EXPECT_NEAR(found[0](4, f) - found[0](0, f), 4, 1e-5);  // bin 4 of 16: a period of 4 frames
    EXPECT_NEAR(found[1](4, f) - found[1](0, f), 8, 1e-5);
  }
  const std::vector<Eigen::VectorXd> dct = dct_embeddings({one});
  Eigen::Index most = 0;
  dct[0].maxCoeff(&most);
  EXPECT_NEAR(double(most), 32, 1);  // half the rate's half
  EXPECT_NEAR(dct_embeddings({Series::Zero(64, 3), one})[0].norm(), 0, 1e-9);
  EXPECT_TRUE(contains(refusal([&] { stft_embeddings({Series::Zero(9, 3)}, 16, 8); }), "Hann"));
}

}  // namespace
}  // namespace mocaplm::filter_test
