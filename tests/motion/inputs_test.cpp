// Names of motions: files, ranges, parts, datasets and their clips.
#include "motion/inputs.h"

#include <gtest/gtest.h>

#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace fs = std::filesystem;

namespace mocaplm::inputs_test {
namespace {

class Inputs : public testing::Test {
 protected:
  void SetUp() override {
    write_dataset(folder_ / "dances", {{"walk", "train", 60}, {"run", "test", 40}});
    write_npz(folder_ / "solo.npz", random_clip(3, 50, 20, "solo"));
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  TemporaryFolder folder_;
};

TEST_F(Inputs, PartsComeAfterTheLastSignWhoseFileIsThere) {
  const auto part = [](const std::string& text) {
    const PartName name = split_part(text);
    return name.file + "|" + name.part;
  };
  EXPECT_EQ(part(at("solo.npz")), at("solo.npz") + "|");
  EXPECT_EQ(part(at("solo.npz#left")), at("solo.npz") + "|left");
  EXPECT_EQ(part(at("solo.npz#take#2")), at("solo.npz") + "|take#2");
  EXPECT_EQ(part(at("none.npz#left")), at("none.npz#left") + "|");
  EXPECT_EQ(part(at("solo.npz#")), at("solo.npz#") + "|");
  EXPECT_EQ(part("#left"), "#left|");
  // A file that is really called so wins; the longest name that is there.
  fs::copy_file(at("solo.npz"), at("solo.npz#take"));
  EXPECT_EQ(part(at("solo.npz#take")), at("solo.npz#take") + "|");
  EXPECT_EQ(part(at("solo.npz#take#2")), at("solo.npz#take") + "|2");
}

TEST_F(Inputs, FilesWithTheSignInTheirNamesAreRead) {
  fs::copy_file(at("solo.npz"), at("a#b.npz"));
  const MotionInput whole = find_motion(at("a#b.npz")), part = find_motion(at("a#b.npz:1-2"));
  EXPECT_EQ(whole.name, "a#b");
  EXPECT_EQ(part.name, "a#b_1-2");
  EXPECT_EQ(part.file(), at("a#b.npz"));
  EXPECT_EQ(read_motion(part, {}).clip.poses, random_clip(3, 50, 20).poses.middleRows(20, 20));
}

TEST_F(Inputs, AFileOfOneMotionHasNoParts) {
  EXPECT_TRUE(contains(refusal([&] { read_one_motion(at("solo.npz#left")); }), "without #left"));
  EXPECT_TRUE(contains(refusal([&] { read_one_motion(at("solo.npz#left:0-1")); }), "solo.npz"));
  EXPECT_TRUE(contains(refusal([&] { read_one_motion(at("none.npz#left")); }), "no such file"));
}

TEST_F(Inputs, ClipsOfADatasetAreItsParts) {
  const Dataset dataset = load_dataset(at("dances"));
  const Clip walk = load_clip(dataset, *dataset.find("walk"));
  const MotionInput whole = find_motion(at("dances#walk")),
                    part = find_motion(at("dances#walk:1-2"));
  EXPECT_EQ(whole.name, "walk");
  EXPECT_EQ(whole.entry()->name, "walk");
  EXPECT_EQ(part.name, "walk_1-2");
  EXPECT_EQ(part.file(), folder_ / "dances/clips/walk.npz");
  EXPECT_EQ(read_motion(whole, {}).clip.poses, walk.poses);
  EXPECT_EQ(read_motion(part, {}).clip.poses, walk.poses.middleRows(20, 20));
  const auto all = find_motions({at("dances"), at("solo.npz"), at("dances#run")}, {});
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[2].name, "solo");
  EXPECT_EQ(all[3].dataset, all[0].dataset) << "loaded once";
  EXPECT_TRUE(contains(refusal<UsageError>([&] { find_motion(at("dances#wakl")); }), "\"walk\""));
  EXPECT_TRUE(contains(refusal<UsageError>([&] { find_motion(at("dances")); }), "dances#run"));
}

TEST_F(Inputs, WhatOnlyFilesNeedIsRefusedWithoutFiles) {
  MotionReading reading;
  reading.fps = 60;
  EXPECT_TRUE(contains(refusal<UsageError>([&] { find_motions({at("dances")}, {}, reading); }),
                       "--source-fps has no effect"));
  EXPECT_NE(refusal<UsageError>([&] { find_motion(at("dances#walk"), reading); }), "");
  // A file among them reads as told, the clips of the dataset are as they were imported.
  const auto both = find_motions({at("dances#walk"), at("solo.npz")}, {}, reading);
  EXPECT_EQ(read_motion(both[0], reading).clip.fps, 20);
  EXPECT_EQ(read_motion(both[1], reading).clip.fps, 60);
}

// First the rate and the frames left out, then the seconds.
TEST_F(Inputs, RangesCountFromWhatIsLeftAtTheTrueRate) {
  MotionReading reading;
  reading.fps = 10;
  reading.drop_first = 7;
  const RangedClip part = read_motion(find_motion(at("solo.npz:1-2.5")), reading);
  EXPECT_EQ(part.from, 1);
  EXPECT_EQ(part.clip.fps, 10);
  EXPECT_EQ(part.clip.poses, random_clip(3, 50, 20).poses.middleRows(17, 15));
  EXPECT_TRUE(contains(refusal<UsageError>([&] { read_one_motion(at("solo.npz:4.3-"), reading); }),
                       "only 4.30 s"));
}

TEST_F(Inputs, OneMotionComesUnderItsOwnName) {
  const MotionInput input = find_motion(at("solo.npz:0.5-1"));
  const std::vector<NamedMotion> motions = read_motions(input, {});
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_EQ(motions[0].name, "solo_0.5-1");
  EXPECT_EQ(motions[0].text, at("solo.npz:0.5-1"));
  ASSERT_EQ(parts_of(input, {}).size(), 1u);
  EXPECT_EQ(parts_of(input, {})[0].text, input.text);
}

// Two persons, as an estimator keeps them: {name: {"pose_world", "trans_world"}}.
TEST_F(Inputs, AFileOfSeveralPeopleIsTakenWholeOrByPart) {
  const fs::path file =
      fs::path(MOCAPLM_SOURCE_DIR) / "../shared/cases/smpl-files-of-other-tools/wham_output.pkl";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  fs::copy_file(file, at("duo.pkl"));
  std::size_t people = 0;
  try {
    people = read_clips(at("duo.pkl")).size();
  } catch (const DataError& error) {
    GTEST_SKIP() << "files of this kind are not read here: " << error.what();
  }
  if (people < 2) GTEST_SKIP() << file << " holds one person";
  const std::vector<NamedMotion> all = read_motions(find_motion(at("duo.pkl")), {});
  ASSERT_EQ(all.size(), people);
  const std::vector<MotionInput> parts = parts_of(find_motion(at("duo.pkl")), {});
  ASSERT_EQ(parts.size(), people);
  for (std::size_t i = 0; i < people; ++i) {
    EXPECT_EQ(all[i].name.rfind("duo_", 0), 0u) << all[i].name;
    EXPECT_EQ(all[i].text, at("duo.pkl#") + all[i].name.substr(4));
    EXPECT_EQ(parts[i].text, all[i].text);
    EXPECT_EQ(find_motion(all[i].text).name, all[i].name);
    EXPECT_EQ(read_one_motion(all[i].text).poses, all[i].read.clip.poses);
  }
  const std::string asked = refusal([&] { read_one_motion(at("duo.pkl")); });
  EXPECT_TRUE(contains(asked, all[0].text)) << asked;
  EXPECT_TRUE(contains(refusal([&] { read_one_motion(at("duo.pkl#nobody")); }), "nobody"));
}

}  // namespace
}  // namespace mocaplm::inputs_test
