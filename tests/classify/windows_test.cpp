// Which windows the classifiers see, and with which classes.
#include "classify/windows.h"

#include <gtest/gtest.h>

#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::windows_test {
namespace {

constexpr std::size_t kWindow = 10;

class Windows : public ::testing::Test {
 protected:
  static Tokenizer tokenizer() {
    TokenizerConfig config;
    config.bins = 50;
    config.joints = {"pelvis", "left_wrist"};
    config.root = "none";
    return Tokenizer::fit(config, {});
  }
  Dataset dataset() {
    return write_dataset(folder_.path(),
                         {{"exact", "train", 10, {{"style", "calm"}}},
                          {"long", "train", 37, {{"style", "wild"}, {"hand", "left hand"}}},
                          {"short", "train", 3, {{"style", "calm"}}},
                          {"bare", "train", 12},
                          {"new", "test", 20, {{"style", "odd"}}},
                          {"known", "test", 20, {{"style", "wild"}}}});
  }
  TemporaryFolder folder_;
};

TEST_F(Windows, TasksAreTheLabelsWithTwoValuesInTheTrainingSplit) {
  const Dataset data = dataset();
  const std::vector<Task> all = make_tasks(data, {}), asked = make_tasks(data, {"style"});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].label, "style");
  EXPECT_EQ(all[0].values, (std::vector<std::string>{"calm", "wild"}));  // "odd" is of the test
  EXPECT_EQ(asked[0].values, all[0].values);
  const std::string unknown = refusal<UsageError>([&] { make_tasks(data, {"stile"}); });
  EXPECT_TRUE(contains(unknown, "did you mean \"style\"") && contains(unknown, "hand")) << unknown;
  const std::string one = refusal<UsageError>([&] { make_tasks(data, {"style", "hand"}); });
  EXPECT_TRUE(contains(one, "hand") && contains(one, "nothing to tell apart")) << one;
}

TEST_F(Windows, NoLabelToTellApartIsRefused) {
  const Dataset data = write_dataset(folder_.path(), {{"a", "train", 10, {{"style", "calm"}}}});
  EXPECT_TRUE(contains(refusal<DataError>([&] { make_tasks(data, {}); }), folder_.path().string()));
}

TEST_F(Windows, EveryHalfWindowAndEachClipsEnd) {
  const Dataset data = dataset();
  const LabelledSplit split =
      label_split(data, "train", tokenizer(), make_tasks(data, {}), kWindow, false, 1);
  const std::map<std::string, std::vector<std::size_t>> expected = {
      {"bare", {0, 2}}, {"exact", {0}}, {"long", {0, 5, 10, 15, 20, 25, 27}}, {"short", {0}}};
  std::map<std::string, std::vector<std::size_t>> found;
  for (const WindowPlace& place : split.windows)
    found[split.clips[place.clip].name].push_back(place.first_frame);
  EXPECT_EQ(found, expected);
}

TEST_F(Windows, ClassesAreIndexesOrMinusOne) {
  const Dataset data = dataset();
  const std::vector<Task> tasks = make_tasks(data, {});
  const LabelledSplit train = label_split(data, "train", tokenizer(), tasks, kWindow, false, 1);
  const std::map<std::string, int> expected = {
      {"bare", -1}, {"exact", 0}, {"long", 1}, {"short", 0}};
  for (const LabelledClip& clip : train.clips)
    EXPECT_EQ(clip.classes, std::vector<int>{expected.at(clip.name)}) << clip.name;
  const LabelledSplit test = label_split(data, "test", tokenizer(), tasks, kWindow, false, 1);
  for (const LabelledClip& clip : test.clips)
    EXPECT_EQ(clip.classes[0], clip.name == "known" ? 1 : -1) << clip.name;
  EXPECT_EQ(window_classes(test, 0).size(), test.windows.size());
  EXPECT_TRUE(contains(refusal<DataError>([&] {
                         label_split(data, "validation", tokenizer(), tasks, kWindow, false, 1);
                       }),
                       "validation"));
}

TEST_F(Windows, ShortClipsHoldTheirLastPose) {
  const Dataset data = dataset();
  const Tokenizer tokens = tokenizer();
  const auto per_frame = static_cast<std::size_t>(tokens.tokens_per_frame());
  const LabelledSplit split =
      label_split(data, "train", tokens, make_tasks(data, {}), kWindow, false, 1);
  const LabelledClip& clip = split.clips.back();
  ASSERT_EQ(clip.name, "short");
  ASSERT_EQ(clip.ids.size(), kWindow * per_frame);
  const auto last = clip.ids.begin() + static_cast<std::ptrdiff_t>(2 * per_frame);
  for (std::size_t t = 3; t < kWindow; ++t)
    EXPECT_TRUE(std::equal(last, last + static_cast<std::ptrdiff_t>(per_frame),
                           clip.ids.begin() + static_cast<std::ptrdiff_t>(t * per_frame)));
  tokens.check_frames(clip.ids, clip.name);
}

TEST_F(Windows, MirroredClipsComeWithMirroredLabels) {
  const Dataset data = write_dataset(folder_.path(), {{"l", "train", 20, {{"hand", "left"}}},
                                                      {"r", "train", 15, {{"hand", "right"}}},
                                                      {"n", "train", 12, {{"hand", "none"}}}});
  const LabelledSplit split =
      label_split(data, "train", tokenizer(), make_tasks(data, {}), kWindow, true, 1);
  ASSERT_EQ(split.clips.size(), 6u);  // l, n, r, then mirrored; classes left, none, right
  const std::vector<int> expected = {0, 1, 2, 2, 1, 0};
  for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(split.clips[c].classes[0], expected[c]) << c;
  EXPECT_NE(split.clips[0].ids, split.clips[3].ids);
}

TEST_F(Windows, FeaturesAreTheChannelsValues) {
  const Dataset data = dataset();
  const Tokenizer tokens = tokenizer();
  const LabelledSplit split =
      label_split(data, "train", tokens, make_tasks(data, {}), kWindow, false, 1);
  const Eigen::MatrixXd features = window_features(split, tokens, kWindow);
  ASSERT_EQ(features.rows(), static_cast<Eigen::Index>(split.windows.size()));
  ASSERT_EQ(features.cols(), static_cast<Eigen::Index>(kWindow) * tokens.channels());
  for (std::size_t w = 0; w < split.windows.size(); ++w) {
    const LabelledClip& clip = split.clips[split.windows[w].clip];
    const Eigen::MatrixXd values = tokens.channel_values(tokens.decode(clip.ids));
    for (Eigen::Index t = 0; t < static_cast<Eigen::Index>(kWindow); ++t)
      for (Eigen::Index c = 0; c < tokens.channels(); ++c)
        EXPECT_NEAR(features(static_cast<Eigen::Index>(w), t * tokens.channels() + c),
                    values(t + static_cast<Eigen::Index>(split.windows[w].first_frame), c), 1e-9);
  }
}

}  // namespace
}  // namespace mocaplm::windows_test
