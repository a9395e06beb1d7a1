#include "spectral/unwound.h"

#include <gtest/gtest.h>

#include "motion/rotation.h"
#include "spectral/measures.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::unwound_test {
namespace {

// A dancer who spins eight times in two seconds, stored in [-pi, pi].
Clip spinning() {
  Clip clip = random_clip(3, 240, 120);
  for (Eigen::Index t = 0; t < 240; ++t)
    clip.poses.row(t).segment<3>(0) =
        axis_angle_from_quaternion(
            quaternion_from_axis_angle(Eigen::Vector3d(0, 0.21 * double(t), 0)))
            .transpose();
  return clip;
}

// Of the pelvis, from one frame to the next.
double largest_jump(const Clip& clip) {
  const auto root = clip.poses.leftCols<3>();
  return (root.bottomRows(clip.frames() - 1) - root.topRows(clip.frames() - 1))
      .cwiseAbs()
      .maxCoeff();
}

TEST(Unwound, HasNoJumpsHoweverOftenItTurns) {
  const Clip clip = spinning(), smooth = unwound(clip), back = wound(smooth);
  EXPECT_GT(largest_jump(clip), 6);
  EXPECT_LT(largest_jump(smooth), 0.5);
  EXPECT_NEAR(smooth.poses(239, 1), 0.21 * 239, 1e-9);
  EXPECT_LT(angle_apart(clip, smooth).most, 1e-5);
  EXPECT_LT(angle_apart(clip, back).most, 1e-5);
  EXPECT_LE(back.poses.leftCols<3>().cwiseAbs().maxCoeff(), 3.14159265358979 + 1e-9);
}

TEST(Unwound, BeginsBesideTheOther) {
  Clip beside = spinning(), clip = beside;
  beside.poses.row(0).segment<3>(0) << 0, 3.0, 0;
  clip.poses.row(0).segment<3>(0) << 0, -3.0, 0;  // 0.28 from 3.0 the other way round
  const Clip found = unwound_beside(clip, beside);
  EXPECT_NEAR(found.poses(0, 1), 2 * 3.14159265358979323846 - 3, 1e-9);
  EXPECT_LT(angle_apart(clip, found).most, 1e-5);
}

}  // namespace
}  // namespace mocaplm::unwound_test
