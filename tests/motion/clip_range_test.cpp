#include "motion/clip_range.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::clip_range_test {
namespace {

TEST(ClipRange, IsReadAsWritten) {
  const ClipRange whole = parse_clip_range("a.npz"), part = parse_clip_range("d:/x.npz:1.5-3");
  EXPECT_EQ(whole.clip, "a.npz");
  EXPECT_EQ(part.clip, "d:/x.npz");
  EXPECT_EQ(part.from, 1.5);
  EXPECT_EQ(part.to, 3);
  EXPECT_EQ(parse_clip_range("a:2-").to, 0);
  EXPECT_EQ(parse_clip_range("a:b").clip, "a:b");
  for (const char* bad : {"a:3-2", "a:-2", "a:1-2-3", "a:1..2-3", "a:-"})
    EXPECT_NE(refusal<UsageError>([&] { parse_clip_range(bad); }), "") << bad;
}

TEST(ClipRange, TakesFramesOfTheClip) {
  const TemporaryFolder folder;
  const Dataset dataset = write_dataset(folder / "data", {{"walk", "train", 60}});
  const Clip clip = load_clip(dataset, dataset.entries[0]);
  const RangedClip part = read_clip_range("walk:1-2", &dataset);
  EXPECT_EQ(part.entry, &dataset.entries[0]);
  EXPECT_EQ(part.from, 1);
  EXPECT_EQ(part.clip.poses, clip.poses.middleRows(20, 20));
  EXPECT_EQ(read_clip_range("walk:1-99", &dataset).clip.frames(), 40);
  const std::string file = (folder / "data/clips/walk.npz").string();
  EXPECT_EQ(read_clip_range(file + ":2.5-", nullptr).clip.frames(), 10);
  EXPECT_TRUE(contains(refusal<UsageError>([&] { read_clip_range("walk:3-4", &dataset); }), "3 s"));
  EXPECT_TRUE(contains(refusal([&] { read_clip_range("wakl", &dataset); }), "walk"));
  EXPECT_NE(refusal([&] { read_clip_range("none.npz", &dataset); }), "");
}

}  // namespace
}  // namespace mocaplm::clip_range_test
