#include "spectral/windows.h"

#include <gtest/gtest.h>

#include "motion/rotation.h"
#include "support/refusal.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::windows_test {
namespace {

TEST(Windows, StartEveryStrideAndEndWithTheClip) {
  using Starts = std::vector<Eigen::Index>;
  EXPECT_EQ(window_starts(127, 128, 32), Starts{});
  EXPECT_EQ(window_starts(128, 128, 32), Starts{0});
  EXPECT_EQ(window_starts(129, 128, 32), (Starts{0, 1}));
  EXPECT_EQ(window_starts(192, 128, 32), (Starts{0, 32, 64}));
  EXPECT_EQ(window_starts(200, 128, 32), (Starts{0, 32, 64, 72}));
}

// The same rotations as in the clip, without jumps, beginning with the shortest vectors.
TEST(Windows, HoldTheClipsRotationsWithoutJumps) {
  Clip clip = random_clip(3, 90, 60);
  for (Eigen::Index t = 0; t < 90; ++t)  // a turn that passes pi and is stored in [-pi, pi]
    clip.poses.row(t).segment<3>(0) =
        axis_angle_from_quaternion(
            quaternion_from_axis_angle(Eigen::Vector3d(0, 2.5 + 0.05 * double(t), 0)))
            .transpose();
  const std::vector<int> joints = {0, 4, 20};
  const Series series = window_series(clip, 5, 80, joints);
  ASSERT_EQ(series.rows(), 80);
  ASSERT_EQ(series.cols(), 9);
  for (Eigen::Index t = 0; t < 80; ++t)
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Vector3d own = series.row(t).segment<3>(3 * i).cast<double>().transpose();
      const Eigen::Vector3d there =
          clip.poses.row(t + 5).segment<3>(3 * joints[std::size_t(i)]).transpose();
      EXPECT_LT(geodesic_angle(quaternion_from_axis_angle(own), quaternion_from_axis_angle(there)),
                1e-5);
      if (t == 0) continue;
      EXPECT_LT((series.row(t) - series.row(t - 1)).cwiseAbs().maxCoeff(), 0.6f);
    }
  EXPECT_GT(series(79, 1), 3.2f);  // on beyond pi
}

TEST(Windows, ShortClipsAreHeldWhenAsked) {
  SpectralConfig config;
  config.window = 16;
  config.fps = 30;
  for (const Eigen::Index frames : {1, 5, 16, 20}) {
    const Clip clip = random_clip(4, frames, 30);
    EXPECT_EQ(at_window_rate(clip, config).frames(), frames);
    config.short_clips = "hold";
    const Clip held = at_window_rate(clip, config);
    EXPECT_EQ(held.frames(), std::max<Eigen::Index>(frames, 16));
    EXPECT_EQ(held.poses.row(held.frames() - 1), clip.poses.row(frames - 1));
    config.short_clips = "skip";
  }
  EXPECT_TRUE(contains(too_short_text(random_clip(1, 10, 30), config), "0.33 s"));
}

TEST(Windows, SettingsThatContradictAreRefused) {
  const auto told = [](const auto& change) {
    SpectralConfig config;
    change(config);
    return refusal<UsageError>([&] { check_config(config); });
  };
  EXPECT_TRUE(contains(told([](auto& c) { c.stft_window = 129; }), "stft_window"));
  EXPECT_TRUE(contains(told([](auto& c) { c.feature = "dct", c.coefficients = 200; }), "200"));
  EXPECT_TRUE(contains(told([](auto& c) { c.joints = {"pelvs"}; }), "pelvis"));
  check_config({});
}

}  // namespace
}  // namespace mocaplm::windows_test
