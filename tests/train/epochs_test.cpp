// Which corpus a step is trained on, and clips that are changed anew.
#include "train/epochs.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include "common/error.h"
#include "common/temporary_folder.h"
#include "motion/turn.h"
#include "support/small_dataset.h"
#include "support/small_models.h"

namespace mocaplm::epochs_test {
namespace {

// One clip of `frames` frames that all hold the epoch as their first bin.
Corpus corpus_of(std::int64_t epoch) {
  Corpus corpus;
  EncodedClip clip;
  for (int t = 0; t < 6; ++t)
    for (const std::int32_t id : {4 + static_cast<std::int32_t>(epoch), 4, 4, 3})
      clip.ids.push_back(id);
  corpus.clips = {clip};
  corpus.frames = 6;
  return corpus;
}

std::int64_t epoch_seen(const WindowSampler& sampler) {
  Random random(1);
  return sampler.draw(random, {}).input.token[1] - 4;
}

TEST(Epochs, EachStepHasItsOwnCorpus) {
  const ModelDescription d = small_description();
  const Corpus first = corpus_of(0);
  Epochs epochs(first, d, 3,
                [](std::int64_t epoch, const std::atomic<bool>&) { return corpus_of(epoch); });
  for (std::int64_t step = 0; step < 14; ++step)
    EXPECT_EQ(epoch_seen(epochs.at(step)), step / 3) << step;
}

TEST(Epochs, ARunThatGoesOnFindsItsPlace) {
  const ModelDescription d = small_description();
  const Corpus first = corpus_of(0);
  Epochs epochs(first, d, 3,
                [](std::int64_t epoch, const std::atomic<bool>&) { return corpus_of(epoch); });
  for (const std::int64_t step : {7, 8, 9, 20})
    EXPECT_EQ(epoch_seen(epochs.at(step)), step / 3) << step;
}

TEST(Epochs, WithoutChangesTheFirstNeverEnds) {
  const ModelDescription d = small_description();
  const Corpus first = corpus_of(0);
  Epochs epochs(first, d, 3, nullptr);
  EXPECT_EQ(&epochs.at(0), &epochs.at(1000));
}

TEST(Epochs, TheNextIsMadeWhileThisOneIsUsed) {
  const ModelDescription d = small_description();
  const Corpus first = corpus_of(0);
  std::atomic<int> made{0};
  Epochs epochs(first, d, 3, [&](std::int64_t epoch, const std::atomic<bool>&) {
    ++made;
    return corpus_of(epoch);
  });
  epochs.at(0);
  for (int i = 0; i < 500 && made == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(made, 1);
}

TEST(Epochs, EndsWithoutWaitingForWhatIsNotNeeded) {
  const ModelDescription d = small_description();
  const Corpus first = corpus_of(0);
  bool stopped = false;
  {
    Epochs epochs(first, d, 3, [&](std::int64_t epoch, const std::atomic<bool>& stop) {
      while (!stop) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      stopped = true;
      return corpus_of(epoch);
    });
    epochs.at(0);
  }
  EXPECT_TRUE(stopped);
}

TEST(Epochs, ErrorsOfTheEncoderAreTold) {
  const ModelDescription d = small_description();
  const Corpus first = corpus_of(0);
  Epochs epochs(first, d, 2, [](std::int64_t, const std::atomic<bool>&) -> Corpus {
    throw DataError(in_file("clip"), "gone");
  });
  EXPECT_NO_THROW(epochs.at(1));
  EXPECT_THROW(epochs.at(2), DataError);
}

TEST(Epochs, HaveEnoughStepsToDrawTheCorpus) {
  EXPECT_EQ(steps_of_an_epoch(10, 8, 20), 100);
  EXPECT_EQ(steps_of_an_epoch(160001, 8, 20), 1001);
}

TEST(Augmentation, TurnsAndChangesTheSpeedBySeed) {
  const Clip clip = random_clip(3, 40, 60);
  Augmentation both{true, 1.25, 5};
  const Clip a = augmented(clip, "x", both), b = augmented(clip, "x", both),
             c = augmented(clip, "y", both);
  EXPECT_TRUE(a.poses == b.poses);
  EXPECT_EQ(a.fps, b.fps);
  EXPECT_NE(a.fps, c.fps);
  EXPECT_FALSE(a.poses == c.poses);
  both.seed = 6;
  EXPECT_NE(augmented(clip, "x", both).fps, a.fps);
  std::set<int> fast;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const double factor = augmented(clip, "x", {false, 1.25, seed}).fps / 60;
    EXPECT_GE(factor, 0.8 - 1e-12);
    EXPECT_LE(factor, 1.25 + 1e-12);
    fast.insert(factor > 1 ? 1 : 0);
    EXPECT_TRUE(augmented(clip, "x", {false, 1.25, seed}).poses == clip.poses);
    EXPECT_EQ(augmented(clip, "x", {true, 1, seed}).fps, 60);
  }
  EXPECT_EQ(fast.size(), 2u);
  EXPECT_TRUE(augmented(clip, "x", {}).poses == clip.poses);
}

TEST(Augmentation, CorporaHaveTheChangedClips) {
  const TemporaryFolder folder;
  const Dataset data =
      write_dataset(folder / "data", {{"a", "train", 60, {}, 60}, {"b", "train", 90, {}, 60}});
  TokenizerConfig config;
  config.bins = 90;
  config.joints = {"root", "left_knee"};
  std::vector<Clip> clips;
  for (const DatasetEntry& entry : data.entries) clips.push_back(load_clip(data, entry));
  const Tokenizer tokenizer = Tokenizer::fit(config, clips);
  const Augmentation augmentation{true, 1.25, 8};
  const Corpus plain = encode_split(data, "train", tokenizer, {}, true, 2),
               other = encode_split(data, "train", tokenizer, {}, true, 1, augmentation);
  ASSERT_EQ(other.clips.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(other.clips[i].name, plain.clips[i].name);
    EXPECT_NE(other.clips[i].ids, plain.clips[i].ids);
  }
  EXPECT_EQ(other.clips[1].ids, tokenizer.encode(augmented(clips[1], "b", augmentation)).ids);
  // The knee and the root's height do not know where the dancer faces.
  const Corpus turned_only = encode_split(data, "train", tokenizer, {}, false, 1, {true, 1, 8});
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  for (std::size_t i = 0; i < turned_only.clips[0].ids.size(); ++i)
    for (const std::size_t channel : {3, 4, 5, 7})
      if (i % per_frame == channel) {
        EXPECT_EQ(turned_only.clips[0].ids[i], plain.clips[0].ids[i]);
      }
}

}  // namespace
}  // namespace mocaplm::epochs_test
