// What is hidden of windows: how much, where, and that nothing of it is seen.
#include "train/masking.h"

#include <gtest/gtest.h>

#include <set>

#include "support/small_models.h"
#include "train/batches.h"

namespace mocaplm::masking_test {
namespace {

constexpr std::size_t kChannels = 9, kPerFrame = 10;
const StreamShape kShape = {40, 4, 30, kChannels};

Corpus small_corpus(const StreamShape& shape, std::uint64_t seed) {
  Random random(seed);
  Corpus corpus;
  for (const std::int64_t frames : {30, 12, 5}) {
    EncodedClip clip;
    clip.ids = random_stream(shape, frames, random);
    clip.labels = {35};
    corpus.frames += frames;
    corpus.clips.push_back(clip);
  }
  return corpus;
}

ModelDescription description(const std::string& objective) {
  ModelDescription d = small_description();
  d.shape = kShape;
  d.config.block_size = 96;
  d.config.objective = objective;
  d.conditions = {"style"};
  return d;
}

TEST(Masking, HidesTheGivenShareOfTheBins) {
  Random random(1);
  WindowOptions options;
  options.mask_share = 0.15;
  std::vector<int> hidden(87);
  for (int i = 0; i < 4000; ++i) {
    const std::vector<bool> mask = draw_mask(kShape, 87, options, random);
    ASSERT_EQ(mask.size(), 87u);
    for (std::size_t t = 0; t < 87; ++t) hidden[t] += mask[t] ? 1 : 0;
  }
  for (std::size_t t = 0; t < 87; ++t) {
    if (t % kPerFrame == kChannels)
      EXPECT_EQ(hidden[t], 0) << t;
    else
      EXPECT_NEAR(hidden[t], 600, 120) << t;
  }
}

TEST(Masking, AlwaysAsksForSomething) {
  Random random(2);
  WindowOptions options;
  options.mask_share = 0.01;
  for (const double spans : {0.0, 1.0})
    for (int i = 0; i < 500; ++i) {
      options.mask_spans = spans;
      const std::vector<bool> mask = draw_mask(kShape, 1 + random.below(25), options, random);
      std::size_t count = 0;
      for (std::size_t t = 0; t < mask.size(); ++t)
        if (mask[t]) {
          ++count;
          EXPECT_LT(t % kPerFrame, kChannels);
        }
      EXPECT_GE(count, 1u);
    }
}

// A stretch hides only joints as a whole group of channels, within one run of frames.
TEST(Masking, SpansHideJointsOverAStretch) {
  Random random(3);
  WindowOptions options;
  options.mask_spans = 1;
  int all_joints = 0, whole = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<bool> mask = draw_mask(kShape, 200, options, random);
    std::set<std::size_t> joints;
    std::size_t count = 0;
    for (std::size_t t = 0; t < mask.size(); ++t)
      if (mask[t]) joints.insert(t % kPerFrame / 3), ++count;
    all_joints += joints.size() == 3 ? 1 : 0;
    whole += count == 180 ? 1 : 0;
  }
  EXPECT_GT(all_joints, 600);
  EXPECT_LT(all_joints, 1400);
  EXPECT_LT(whole, 60);
}

TEST(Masking, JointSubsetsAreWholeJointsAndNeverAll) {
  Random random(4);
  WindowOptions options;
  options.joint_subset = 0.5;
  int some = 0;
  std::set<std::size_t> sizes;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<bool> hidden = draw_hidden_channels(kShape, options, random);
    if (hidden.empty()) continue;
    ++some;
    std::size_t joints = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(hidden[3 * j], hidden[3 * j + 1]);
      EXPECT_EQ(hidden[3 * j], hidden[3 * j + 2]);
      joints += hidden[3 * j] ? 1 : 0;
    }
    sizes.insert(joints);
  }
  EXPECT_NEAR(some, 1000, 120);
  EXPECT_EQ(sizes, (std::set<std::size_t>{1, 2}));
}

void expect_same_input(const ModelInput& a, const ModelInput& b) {
  for (auto list :
       {&ModelInput::token, &ModelInput::frame, &ModelInput::channel, &ModelInput::centre,
        &ModelInput::surprise, &ModelInput::velocity, &ModelInput::last_surprise})
    EXPECT_EQ(a.*list, b.*list);
}

// Whatever is hidden may be anything: the input stays as it is, and so every logit does.
TEST(MaskedWindows, WhatIsHiddenNeverChangesTheInput) {
  const ModelDescription d = description("masked");
  Random random(5);
  for (int round = 0; round < 300; ++round) {
    const Corpus corpus = small_corpus(kShape, 100 + static_cast<std::uint64_t>(round));
    WindowOptions options;
    options.mask_spans = round % 2 == 0 ? 1 : 0;
    options.joint_subset = round % 3 == 0 ? 1 : 0;
    const std::size_t clip = random.below(3), first = random.below(3);
    Random one(7 + static_cast<std::uint64_t>(round)), again = one;
    const Window w = make_window(corpus, d, clip, first, options, one);
    Corpus changed = corpus;
    int targets = 0;
    for (std::size_t p = 0; p < w.target.size(); ++p) {
      if (w.target[p] < 0) continue;
      ++targets;
      const std::size_t index = kPerFrame * first + p - 2;  // behind start and condition
      EXPECT_EQ(w.target[p], corpus.clips[clip].ids[index]);
      EXPECT_EQ(w.input.token[p], Tokenizer::kMask);
      EXPECT_EQ(w.input.surprise[p], 0);
      changed.clips[clip].ids[index] = 4 + (w.target[p] - 4 + 11) % 30;
    }
    if (options.joint_subset == 0) {
      EXPECT_GT(targets, 0);
    }
    const Window other = make_window(changed, d, clip, first, options, again);
    expect_same_input(w.input, other.input);
    for (std::size_t p = 0; p < w.target.size(); ++p)
      EXPECT_EQ(other.target[p] >= 0, w.target[p] >= 0);
    if (HasFailure()) FAIL() << "in round " << round;
  }
}

// Of joints that are taken away nothing is seen, and nothing is asked.
TEST(JointSubsets, HiddenJointsAreNeitherSeenNorAskedFor) {
  const ModelDescription d = description("causal");
  WindowOptions options;
  options.joint_subset = 1;
  for (int round = 0; round < 200; ++round) {
    const Corpus corpus = small_corpus(kShape, 500 + static_cast<std::uint64_t>(round));
    Random one(static_cast<std::uint64_t>(round)), again = one, third = one;
    const Window w = make_window(corpus, d, 0, 5, options, one);
    std::set<std::size_t> hidden;
    for (std::size_t p = 2; p < w.input.size(); ++p)
      if (w.input.token[p] == Tokenizer::kMask) hidden.insert((p - 2) % kPerFrame);
    ASSERT_FALSE(hidden.empty());
    for (std::size_t p = 1; p < w.target.size(); ++p) {
      const std::size_t next = (p - 1) % kPerFrame;
      if (hidden.count(next) > 0)
        EXPECT_EQ(w.target[p], -1);
      else
        EXPECT_EQ(w.target[p], corpus.clips[0].ids[5 * kPerFrame + p - 1]);
    }
    Corpus changed = corpus;
    for (std::size_t i = 0; i < changed.clips[0].ids.size(); ++i)
      if (hidden.count(i % kPerFrame) > 0) changed.clips[0].ids[i] = 4 + static_cast<int>(i % 30);
    expect_same_input(w.input, make_window(changed, d, 0, 5, options, again).input);
    // With nothing hidden the other channels are told the same.
    const Window whole = make_window(corpus, d, 0, 5, {}, third);
    for (std::size_t p = 2; p < w.input.size(); ++p) {
      const std::size_t next = (p - 1) % kPerFrame;
      if (hidden.count(next) == 0) {
        EXPECT_EQ(w.input.centre[p], whole.input.centre[p]);
      }
    }
    if (HasFailure()) FAIL() << "in round " << round;
  }
}

TEST(Batches, AreTheSameWheneverTheyAreDrawn) {
  const ModelDescription d = description("masked");
  const Corpus corpus = small_corpus(kShape, 9);
  const WindowSampler sampler(corpus, d);
  TrainConfig config;
  config.batch_size = 5;
  config.micro_batch = 2;
  const MicroBatches a = draw_batches(sampler, config, 3), b = draw_batches(sampler, config, 3),
                     c = draw_batches(sampler, config, 4);
  ASSERT_EQ(a.batches.size(), 3u);
  EXPECT_EQ(a.targets, b.targets);
  std::int64_t targets = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(at::equal(a.batches[i].token, b.batches[i].token));
    EXPECT_TRUE(at::equal(a.batches[i].target, b.batches[i].target));
    EXPECT_FALSE(at::equal(a.batches[i].token, c.batches[i].token));
    targets += (a.batches[i].target >= 0).sum().item<std::int64_t>();
  }
  EXPECT_EQ(targets, a.targets);
}

}  // namespace
}  // namespace mocaplm::masking_test
