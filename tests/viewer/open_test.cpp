#include "viewer/open.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/dataset_write.h"
#include "support/refusal.h"

namespace mocaplm::open_test {
namespace {

namespace fs = std::filesystem;

class OpenTest : public testing::Test {
 protected:
  void SetUp() override {
    clip_.name = "still";
    clip_.fps = 30;
    clip_.poses = Poses::Zero(5, 72);
    clip_.trans = Translations::Zero(5, 3);
    write_clip(directory_ / "still.npz", clip_);
  }

  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  ViewOptions of(std::vector<std::string> inputs) const {
    ViewOptions options;
    options.inputs = std::move(inputs);
    return options;
  }

  // The message of the UsageError or DataError that opening raises.
  template <class Wanted>
  std::string message(const ViewOptions& options) const {
    return refusal<Wanted>([&] { open_page(options); });
  }

  TemporaryFolder directory_;
  Clip clip_;
};

TEST_F(OpenTest, ReadsFilesInTheGivenOrder) {
  clip_.poses.setConstant(0.1);
  write_clip(directory_ / "other.npz", clip_);
  ViewOptions options = of({file("still.npz"), file("other.npz"), file("still.npz")});
  options.joints = {"right_arm"};
  options.trails = {"left_wrist"};
  const Page page = open_page(options);
  ASSERT_EQ(page.motions.size(), 3u);
  EXPECT_EQ(page.motions[1].title, "other");
  EXPECT_NEAR(page.motions[1].clip.poses(0, 0), 0.1, 1e-9);
  EXPECT_EQ(page.motions[0].highlighted_joints, (std::vector<int>{17, 19, 21}));
  EXPECT_EQ(page.motions[0].trails, (std::vector<int>{20}));
  EXPECT_EQ(page.title, "still, other, still");
  EXPECT_TRUE(page.note.empty());
}

TEST_F(OpenTest, OverridesTheRate) {
  ViewOptions options = of({file("still.npz")});
  options.read.fps = 60;
  EXPECT_EQ(open_page(options).motions[0].clip.fps, 60);
}

TEST_F(OpenTest, ShowsAPartOfAMotion) {
  const Page page = open_page(of({file("still.npz") + ":0.04-0.1"}));
  ASSERT_EQ(page.motions.size(), 1u);
  EXPECT_EQ(page.motions[0].title, "still_0.04-0.1");
  EXPECT_EQ(page.motions[0].clip.frames(), 2);
  EXPECT_NE(message<UsageError>(of({file("still.npz") + ":1-2"})).find("begins at 1"),
            std::string::npos);
}

TEST_F(OpenTest, NamesWhatIsWrong) {
  EXPECT_THROW(open_page(of({})), UsageError);
  EXPECT_NE(message<DataError>(of({file("absent.npz")})).find("absent.npz"), std::string::npos);
  EXPECT_NE(message<DataError>(of({directory_.path().string()})).find("dataset.json"),
            std::string::npos);
  ViewOptions options = of({file("still.npz")});
  options.joints = {"right_arn"};
  EXPECT_NE(message<UsageError>(options).find("right_arm"), std::string::npos);
  options = of({file("still.npz")});
  options.clips = {"walk"};
  EXPECT_NE(message<UsageError>(options).find("--clip"), std::string::npos);
  EXPECT_THROW(open_page(of(std::vector<std::string>(kMaxPageMotions + 1, file("still.npz")))),
               UsageError);
}

TEST_F(OpenTest, RefusesTruncatedFilesAtEveryLength) {
  const std::string whole = read_file(file("still.npz"));
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 7) {
    write_file(file("cut.npz"), whole.substr(0, size));
    EXPECT_THROW(open_page(of({file("cut.npz")})), DataError) << size;
  }
}

TEST_F(OpenTest, ShowsClipsOfADatasetAndSaysThatTheyAreProcedural) {
  const fs::path folder = directory_ / "dances";
  write_dataset(folder, Existing::refuse, [this](const fs::path& fresh) {
    Dataset dataset;
    dataset.procedural = true;
    for (int i = 0; i < 9; ++i) {
      DatasetEntry entry;
      entry.name = entry.group = "clip" + std::to_string(i);
      entry.file = clip_file(entry.name);
      entry.frames = clip_.frames();
      entry.fps = clip_.fps;
      entry.split = "train";
      entry.labels = {{"genre", "waack"}};
      store_clip(fresh, entry, clip_);
      dataset.entries.push_back(entry);
    }
    return dataset;
  });
  std::vector<std::string> remarks;
  ViewOptions options = of({folder.string()});
  Page page = open_page(options, &remarks);
  EXPECT_EQ(page.motions.size(), kDatasetPreview);
  EXPECT_EQ(page.title, "6 motions of dances");
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("of 9 clips"), std::string::npos);
  EXPECT_NE(page.note.find("procedural"), std::string::npos);
  options.clips = {"clip8", "clip2"};
  page = open_page(options);
  ASSERT_EQ(page.motions.size(), 2u);
  EXPECT_EQ(page.motions[0].title, "clip8");
  EXPECT_EQ(page.motions[0].clip.labels.at("genre"), "waack");
  options.clips = {"clip4:0.1-"};
  page = open_page(options);
  EXPECT_EQ(page.motions[0].clip.frames(), 2);
  EXPECT_EQ(page.motions[0].caption, "train clip of " + folder.string());
  options.clips = {"clip88"};
  EXPECT_NE(message<UsageError>(options).find("did you mean \"clip8\""), std::string::npos);
}

TEST(PagePath, MustBeHtml) {
  EXPECT_NO_THROW(check_page_path("a/page.HTML"));
  EXPECT_NO_THROW(check_page_path("page.htm"));
  EXPECT_THROW(check_page_path("dance.npz"), UsageError);
  EXPECT_THROW(check_page_path("page"), UsageError);
}

}  // namespace
}  // namespace mocaplm::open_test
