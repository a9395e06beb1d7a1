#include "motion/clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/error.h"
#include "motion/helpers.h"

namespace mocaplm::clip_test {
namespace {

std::string refusal(const Clip& clip) {
  try {
    check_clip(clip, "a.npz");
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

TEST(Clip, SoundClipsPass) {
  Random random(41);
  const Clip clip = random_clip(random, 12, 60);
  EXPECT_EQ(refusal(clip), "");
  EXPECT_EQ(clip.frames(), 12);
  EXPECT_DOUBLE_EQ(clip.seconds(), 0.2);
  EXPECT_EQ(Clip().seconds(), 0);
}

TEST(Clip, NamesFrameAndJointOfTheFirstBadValue) {
  Random random(42);
  const Clip good = random_clip(random, 12, 60);
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1e7}) {
    Clip clip = good;
    clip.poses(7, 3 * 21 + 2) = bad;
    clip.poses(9, 0) = bad;
    EXPECT_NE(refusal(clip).find("a.npz: frame 7, joint right_wrist"), std::string::npos)
        << refusal(clip);
    clip = good;
    clip.trans(5, 1) = bad;
    EXPECT_NE(refusal(clip).find("a.npz: frame 5"), std::string::npos) << refusal(clip);
  }
}

TEST(Clip, RefusesWrongShapesAndRates) {
  Random random(43);
  const Clip good = random_clip(random, 12, 60);
  EXPECT_NE(refusal(Clip()), "");
  Clip clip = good;
  clip.trans.conservativeResize(11, 3);
  EXPECT_NE(refusal(clip).find("12"), std::string::npos);
  for (double fps :
       {0.0, -1.0, 1e-300, 10001.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    clip = good;
    clip.fps = fps;
    EXPECT_NE(refusal(clip).find("frame rate"), std::string::npos) << fps;
  }
}

TEST(Clip, SliceKeepsEverythingElse) {
  Random random(44);
  Clip clip = random_clip(random, 12, 60);
  clip.labels = {{"genre", "waack"}};
  const Clip part = slice(clip, 3, 5);
  EXPECT_EQ(part.frames(), 5);
  EXPECT_TRUE(part.poses == clip.poses.middleRows(3, 5));
  EXPECT_TRUE(part.trans == clip.trans.middleRows(3, 5));
  EXPECT_EQ(part.labels, clip.labels);
  EXPECT_EQ(part.name, clip.name);
  EXPECT_EQ(part.fps, 60);
  EXPECT_EQ(slice(clip, 12, 0).frames(), 0);
}

}  // namespace
}  // namespace mocaplm::clip_test
