// A dataset as token streams, and the windows cut from it.
#include "train/corpus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "common/temporary_folder.h"
#include "model/directory.h"
#include "motion/mirror.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "train/stream_shape.h"

namespace mocaplm::corpus_test {

namespace {

class TrainCorpus : public testing::Test {
 protected:
  void SetUp() override {
    dataset_ = write_dataset(folder_ / "data",
                             {{"long", "train", 60, {{"style", "calm"}, {"dancer", "d1"}}},
                              {"middle", "train", 41, {{"style", "wild"}}, 40},
                              {"short", "train", 4, {{"dancer", "d9"}}},
                              {"stub", "train", 2, {}},
                              {"held", "validation", 30, {{"style", "calm"}}}});
    TokenizerConfig config;
    config.bins = 24;
    config.joints = {"left_knee"};
    config.root = "none";  // 3 channels, 4 tokens a frame
    tokenizer_ = Tokenizer::fit(config, {});
    tokenizer_.add_label_values("style", {"calm", "wild"});
    tokenizer_.add_label_values("dancer", {"d1"});
    model_.config.block_size = 35;
    model_.config.reach = 5;
    model_.conditions = {"style", "dancer"};
    model_.shape = stream_shape(tokenizer_);
    corpus_ = encode_split(dataset_, "train", tokenizer_, model_.conditions, false, 2);
  }
  std::int32_t id(const char* label, const char* value) const {
    return tokenizer_.label_id(label, value);
  }

  TemporaryFolder folder_;
  Dataset dataset_;
  Tokenizer tokenizer_;
  ModelDescription model_;
  Corpus corpus_;
  Random random_{1};
};

TEST_F(TrainCorpus, ClipsAreEncodedWithTheirLabels) {
  ASSERT_EQ(corpus_.clips.size(), 3u);  // two frames are too few
  EXPECT_EQ(corpus_.frames, 60 + 21 + 4);
  const std::vector<std::pair<std::string, std::vector<std::int32_t>>> expected = {
      {"long", {id("style", "calm"), id("dancer", "d1")}},
      {"middle", {id("style", "wild"), Tokenizer::kMask}},
      {"short", {Tokenizer::kMask, Tokenizer::kMask}}};  // a dancer the tokenizer does not know
  for (std::size_t i = 0; i < 3; ++i) {
    const EncodedClip& clip = corpus_.clips[i];
    EXPECT_EQ(clip.name, expected[i].first);
    EXPECT_EQ(clip.labels, expected[i].second);
    for (const DatasetEntry& entry : dataset_.entries)
      if (entry.name == clip.name) {
        EXPECT_EQ(clip.ids, tokenizer_.encode(load_clip(dataset_, entry)).ids);
        EXPECT_EQ(clip.values, entry.labels);
      }
  }
}

TEST_F(TrainCorpus, MirroredTwinsComeAfterTheClips) {
  const Corpus both = encode_split(dataset_, "train", tokenizer_, model_.conditions, true, 1);
  ASSERT_EQ(both.clips.size(), 6u);
  EXPECT_EQ(both.frames, 2 * corpus_.frames);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(both.clips[i].ids, corpus_.clips[i].ids);
    EXPECT_EQ(both.clips[i + 3].labels, corpus_.clips[i].labels);
    EXPECT_EQ(both.clips[i + 3].name, corpus_.clips[i].name + " (mirrored)");
  }
  const Clip clip = load_clip(dataset_, dataset_.split("train")[0]);
  EXPECT_EQ(both.clips[3].ids, tokenizer_.encode(mirror(clip)).ids);
}

TEST_F(TrainCorpus, SplitsWithNothingToLearnAreRefused) {
  const std::string message = refusal<DataError>(
      [&] { encode_split(dataset_, "test", tokenizer_, model_.conditions, false, 1); });
  EXPECT_TRUE(contains(message, "\"test\"")) << message;
  const Dataset stubs = write_dataset(folder_ / "stubs", {{"stub", "train", 2}});
  EXPECT_THROW(encode_split(stubs, "train", tokenizer_, {}, false, 1), DataError);
}

// Every target is the id that comes next in the stream, and the rest is ignored.
TEST_F(TrainCorpus, TargetsAreTheNextIds) {
  const std::size_t prefix = 3;
  for (std::size_t c = 0; c < corpus_.clips.size(); ++c) {
    const EncodedClip& clip = corpus_.clips[c];
    for (std::size_t frame = 0; 4 * frame < clip.ids.size(); ++frame)
      for (const std::int64_t reserve : {0, 2}) {
        const Window w = make_window(corpus_, model_, c, frame, {}, random_, reserve);
        const auto length = static_cast<std::size_t>(model_.config.block_size - reserve);
        const std::size_t count = std::min(length - prefix, clip.ids.size() - 4 * frame);
        ASSERT_EQ(w.input.size(), length);
        ASSERT_EQ(w.target.size(), length);
        EXPECT_EQ(w.clip, c);
        EXPECT_EQ(w.first_frame, frame);
        EXPECT_EQ(w.frames, count / 4);
        EXPECT_EQ(w.input.token[0], Tokenizer::kStart);
        EXPECT_EQ(w.input.token[1], clip.labels[0]);
        EXPECT_EQ(w.input.token[2], clip.labels[1]);
        for (std::size_t p = 0; p < length; ++p) {
          const std::size_t next = 4 * frame + p + 1 - prefix;
          const bool known = p + 1 >= prefix && p < prefix + count && next < clip.ids.size();
          ASSERT_EQ(w.target[p], known ? clip.ids[next] : -1) << p;
          if (p >= prefix) {
            ASSERT_EQ(w.input.token[p], p < prefix + count ? clip.ids[next - 1] : Tokenizer::kPad);
          }
        }
        EXPECT_NO_THROW(check_input(w.input, model_, "window"));
      }
  }
}

TEST_F(TrainCorpus, ConditionsAreHiddenAtTheGivenShare) {
  int hidden[2] = {0, 0};
  for (int i = 0; i < 2000; ++i) {
    const Window w = make_window(corpus_, model_, 0, 5, {0.25}, random_);
    for (const int at : {0, 1}) {
      const std::int32_t token = w.input.token[static_cast<std::size_t>(1 + at)];
      EXPECT_TRUE(token == Tokenizer::kMask ||
                  token == corpus_.clips[0].labels[static_cast<std::size_t>(at)]);
      hidden[at] += token == Tokenizer::kMask ? 1 : 0;
    }
  }
  for (const int count : hidden) EXPECT_NEAR(count, 500, 100);
  const Window all = make_window(corpus_, model_, 0, 5, {1}, random_);
  EXPECT_EQ(all.input.token[1], Tokenizer::kMask);
  EXPECT_EQ(all.input.token[2], Tokenizer::kMask);
}

TEST_F(TrainCorpus, SamplerDrawsClipsByLengthAndStartsEvenly) {
  ASSERT_EQ(window_frames(model_), 8u);
  EXPECT_EQ(window_frames(model_, 4), 7u);
  const WindowSampler sampler(corpus_, model_);
  std::map<std::size_t, int> clips;
  std::map<std::size_t, int> starts;  // of the long clip
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Window w = sampler.draw(random_, {});
    ++clips[w.clip];
    if (w.clip == 0) ++starts[w.first_frame];
    if (w.clip == 2) {
      EXPECT_EQ(w.first_frame, 0u);
    }
  }
  const double frames[] = {60, 21, 4};
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(clips[c] / double{kDraws}, frames[c] / 85, 0.02) << c;
  ASSERT_EQ(starts.size(), 60u - 8 + 1);  // the last window ends with the clip
  for (const auto& [start, count] : starts)
    EXPECT_NEAR(count, clips[0] / 53.0, 5 * std::sqrt(clips[0] / 53.0)) << start;
}

TEST_F(TrainCorpus, EvenWindowsTileTheCorpusAndNeverChange) {
  std::set<std::pair<std::size_t, std::size_t>> places;
  const std::vector<Window> all = even_windows(corpus_, model_, 1000);
  for (const Window& w : all) {
    EXPECT_TRUE(places.emplace(w.clip, w.first_frame).second);
    EXPECT_EQ(w.first_frame % 8, 0u);
  }
  EXPECT_EQ(all.size(), 8u + 3u + 1u);
  const std::vector<Window> some = even_windows(corpus_, model_, 4),
                            again = even_windows(corpus_, model_, 4);
  ASSERT_EQ(some.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(places.count({some[i].clip, some[i].first_frame}));
    EXPECT_EQ(some[i].input.token, again[i].input.token);
  }
  EXPECT_EQ(some[3].clip, 1u);  // spread over the clips, not the first ones
}

}  // namespace

}  // namespace mocaplm::corpus_test
