// From a prompt to a dance with a tiny random model: what is kept, what is refused, and that the
// sliding context is what a fresh context would be.
#include "generate/generator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "generate/engine.h"
#include "motion/skeleton.h"
#include "support/refusal.h"
#include "support/small_models.h"
#include "tokenizer/random_clips.h"
#include "train/stream_shape.h"

namespace mocaplm::generator_test {

namespace {

const int kKnee = joint_index("left_knee"), kElbow = joint_index("right_elbow");

// 2 joints and the root: 9 channels, 10 tokens a frame; a context of 5 frames.
StoredModel dancing_model(const std::string& position = "custom",
                          const std::string& root = "steps") {
  TokenizerConfig config;
  config.bins = 16;
  config.fps = 20;
  config.joints = {"left_knee", "right_elbow"};
  config.root = root;
  Tokenizer tokenizer = Tokenizer::fit(config, {random_clip(1, 100)});
  tokenizer.add_label_values("style", {"calm", "wild"});
  tokenizer.add_label_values("content", {"walk"});
  StoredModel model;
  model.description = small_description(position);
  model.description.config.block_size = 57;
  model.description.shape = stream_shape(tokenizer);
  model.description.tokenizer_fingerprint = tokenizer.fingerprint();
  model.description.conditions = {"style", "content"};
  model.tensors = random_weights(model.description, 2);
  model.tokenizer = tokenizer.to_json();
  return model;
}

class Dance : public testing::Test {
 protected:
  static GenerateRequest request(double seconds) {
    GenerateRequest r;
    r.seconds = seconds;
    r.sampling.top_p = 1;
    return r;
  }
  std::string usage(const GenerateRequest& r) {
    return refusal<UsageError>([&] { generator_.generate(r); });
  }
  std::string data(const GenerateRequest& r) {
    return refusal<DataError>([&] { generator_.generate(r); });
  }

  StoredModel model_ = dancing_model();
  Generator generator_{model_, "m"};
};

auto joint(const Clip& clip, int index) {
  return clip.poses.middleCols(3 * index, 3);
}

TEST_F(Dance, HasTheLengthAndTheJointsAskedFor) {
  std::vector<std::size_t> steps;
  const GenerateResult r = generator_.generate(request(1.5), [&](const GeneratedFrame& frame) {
    EXPECT_EQ(frame.frames, 30u);
    EXPECT_EQ(frame.dance, 0u);
    steps.push_back(frame.index + 1);
  });
  ASSERT_EQ(steps.size(), 30u);
  EXPECT_EQ(steps.front(), 1u);
  EXPECT_EQ(steps.back(), 30u);
  EXPECT_EQ(r.clip.frames(), 30);
  EXPECT_EQ(r.clip.fps, 20);
  EXPECT_EQ(r.context.frames(), 0);
  EXPECT_NO_THROW(check_clip(r.clip, "generated"));
  for (int j = 0; j < kJoints; ++j)
    EXPECT_EQ(joint(r.clip, j).cwiseAbs().maxCoeff() > 0, j == kKnee || j == kElbow) << j;
}

TEST_F(Dance, PromptedJointsAreKeptExactly) {
  GenerateRequest r = request(2);
  r.prompt = random_clip(3, 25);
  r.joints = {kKnee};
  const GenerateResult result = generator_.generate(r);
  EXPECT_EQ(result.joints, std::vector<int>({kKnee}));
  ASSERT_EQ(result.clip.frames(), 40);
  EXPECT_EQ(joint(result.clip, kKnee).topRows(25), joint(*r.prompt, kKnee));
  EXPECT_GT((joint(result.clip, kElbow).topRows(25) - joint(*r.prompt, kElbow)).norm(), 1);
  EXPECT_EQ(result.notes.size(), 1u);  // the prompt is shorter
  EXPECT_EQ(result.context.frames(), 25);
  // The other way round, with a prompt longer than the result.
  r = request(1);
  r.prompt = random_clip(4, 60);
  r.joints = {kElbow, joint_index("head")};
  const GenerateResult other = generator_.generate(r);
  EXPECT_EQ(other.clip.frames(), 20);
  EXPECT_EQ(joint(other.clip, kElbow), joint(*r.prompt, kElbow).topRows(20));
  EXPECT_EQ(other.joints, std::vector<int>({kElbow}));
  EXPECT_TRUE(contains(other.notes.at(0), "right_elbow"));
}

TEST_F(Dance, AContinuedPromptIsKept) {
  GenerateRequest r = request(1);
  r.prompt = random_clip(5, 33);
  const GenerateResult result = generator_.generate(r);
  ASSERT_EQ(result.clip.frames(), 53);
  for (const int j : {kKnee, kElbow})
    EXPECT_EQ(joint(result.clip, j).topRows(33), joint(*r.prompt, j));
  for (const int axis : {0, 2})  // it starts where the prompt starts; the height is a bin's
    EXPECT_NEAR(result.clip.trans(0, axis), r.prompt->trans(0, axis), 1e-9);
  r.prompt_seconds = 0.5;
  EXPECT_EQ(generator_.generate(r).clip.frames(), 30);
}

TEST_F(Dance, APromptOfAnotherRateIsResampled) {
  GenerateRequest r = request(1);
  r.prompt = random_clip(6, 121, 120);
  const GenerateResult result = generator_.generate(r);
  EXPECT_EQ(result.context.frames(), 21);
  EXPECT_EQ(result.clip.frames(), 41);
  EXPECT_TRUE(contains(result.notes.at(0), "resampled from 120 to 20"));
}

// The ids of a generated clip; decoded motion is encoded to the very same tokens.
std::vector<std::int32_t> ids_of(const Generator& generator, const Clip& clip) {
  return generator.tokenizer().encode(clip).ids;
}

// Chooses again, each token from a context computed afresh, sliding by the rule of the header:
// where the context is full the older half of its frames is forgotten.
void expect_greedy_in_fresh_contexts(const StoredModel& model, const std::vector<std::int32_t>& ids,
                                     const std::vector<std::int32_t>& prefix, std::size_t given) {
  Engine engine(model, "m");
  const auto per = static_cast<std::size_t>(model.description.shape.tokens_per_frame());
  const auto capacity = static_cast<std::size_t>(engine.capacity());
  const std::size_t frames = (capacity - prefix.size()) / per;
  std::size_t first = 0, slides = 0;
  for (std::size_t at = 0; at < ids.size(); ++at) {
    if (at % per + 1 == per) {
      EXPECT_EQ(ids[at], Tokenizer::kSeparator);
    } else if (at >= given) {
      engine.reset();
      const auto logits =
          engine.feed(window_input(model.description, prefix, ids, first, at - first));
      const auto begin = logits.begin() + Tokenizer::kFirstBin;
      const float best = *std::max_element(begin, begin + model.description.shape.bins);
      ASSERT_GE(logits[static_cast<std::size_t>(ids[at])], best - 1e-4f) << "token " << at;
    }
    if (prefix.size() + at - first >= capacity) {
      first = (at / per - std::min(at / per, frames / 2)) * per;
      ++slides;
    }
  }
  EXPECT_GT(slides, 10u);
}

TEST_F(Dance, SlidingContextsAreWhatFreshContextsWouldBe) {
  for (const char* position : {"custom", "absolute"}) {
    // The step into the first frame is not in a clip, so that only absolute ids come back.
    const StoredModel model = dancing_model(position, "absolute");
    Generator generator(model, "m");
    GenerateRequest r = request(3);
    r.sampling.strategy = "greedy";
    const std::vector<std::int32_t> open = {Tokenizer::kStart, Tokenizer::kMask, Tokenizer::kMask};
    expect_greedy_in_fresh_contexts(model, ids_of(generator, generator.generate(r).clip), open, 0);
    // Behind a prompt of decoded motion, which is its own tokens.
    r.prompt = generator.tokenizer().decode(generator.tokenizer().encode(random_clip(7, 23)).ids,
                                            "prompt");
    r.labels = {{"style", "wild"}};
    const std::vector<std::int32_t> wild = {
        Tokenizer::kStart, generator.tokenizer().label_id("style", "wild"), Tokenizer::kMask};
    const Clip clip = generator.generate(r).clip;
    EXPECT_EQ(clip.labels, r.labels);
    expect_greedy_in_fresh_contexts(model, ids_of(generator, clip), wild, 230);
  }
}

TEST_F(Dance, RepeatsBySeedWhateverCameBefore) {
  GenerateRequest r = request(1);
  const GenerateResult first = generator_.generate(r);
  generator_.generate(request(2));
  EXPECT_EQ(generator_.generate(r).clip.poses, first.clip.poses);
  EXPECT_EQ(Generator(model_, "m").generate(r).clip.poses, first.clip.poses);
  r.sampling.seed = 2;
  EXPECT_NE(generator_.generate(r).clip.poses, first.clip.poses);
}

// Several dances side by side, each with a request of its own, are what each is alone; more of them
// than sequences wait for their turn.
TEST_F(Dance, ManyAtOnceAreWhatEachIsAlone) {
  std::vector<GenerateRequest> requests;
  for (int i = 0; i < 7; ++i) {
    GenerateRequest r = request(0.5 + 0.3 * i);
    r.sampling.seed = i;
    if (i % 3 == 1) r.prompt = random_clip(static_cast<std::uint64_t>(20 + i), 15);
    if (i == 4) r.joints = {kKnee};
    if (i == 5) r.labels = {{"style", "wild"}};
    requests.push_back(r);
  }
  for (const Precision precision : {Precision::f32, Precision::int8}) {
    Generator alone(model_, "m", {precision, 1, 1}), together(model_, "m", {precision, 2, 3});
    std::vector<std::size_t> frames(requests.size(), 0);
    std::vector<Clip> told(requests.size());
    const auto results = together.generate(requests, [&](const GeneratedFrame& frame) {
      EXPECT_EQ(frame.index, frames[frame.dance]++);
      Clip& clip = told[frame.dance];
      clip.poses.conservativeResize(clip.poses.rows() + 1, 72);
      clip.trans.conservativeResize(clip.trans.rows() + 1, 3);
      clip.poses.bottomRows(1) = frame.pose.poses;
      clip.trans.bottomRows(1) = frame.pose.trans;
    });
    ASSERT_EQ(results.size(), requests.size());
    for (std::size_t i = 0; i < requests.size(); ++i) {
      const GenerateResult one = alone.generate(requests[i]);
      EXPECT_EQ(results[i].clip.poses, one.clip.poses) << i;
      EXPECT_EQ(results[i].clip.trans, one.clip.trans) << i;
      EXPECT_EQ(results[i].notes, one.notes);
      // The frames that were told one by one are the same dance.
      EXPECT_EQ(told[i].poses, one.clip.poses) << i;
      EXPECT_LT((told[i].trans - one.clip.trans).norm(), 1e-9) << i;
    }
  }
}

TEST_F(Dance, ConditionsChangeTheDance) {
  GenerateRequest r = request(1);
  const Clip open = generator_.generate(r).clip;
  r.labels = {{"style", "calm"}};
  const Clip calm = generator_.generate(r).clip;
  r.labels = {{"style", "wild"}};
  EXPECT_NE(calm.poses, open.poses);
  EXPECT_NE(generator_.generate(r).clip.poses, calm.poses);
}

TEST_F(Dance, UnknownLabelsAreDataErrorsThatSayWhatThereIs) {
  GenerateRequest r = request(1);
  r.labels = {{"style", "cal"}};
  EXPECT_TRUE(contains(data(r), "calm"));
  r.labels = {{"stile", "calm"}};
  EXPECT_TRUE(contains(data(r), "did you mean \"style\""));
  EXPECT_TRUE(contains(data(r), "content"));
  StoredModel plain = model_;
  plain.description.conditions.clear();
  r.labels = {{"style", "calm"}};
  Generator generator(plain, "m");
  EXPECT_TRUE(contains(refusal<DataError>([&] { generator.generate(r); }), "without condition"));
}

TEST_F(Dance, RequestsThatCannotBeAreUsageErrors) {
  for (const double seconds : {0.0, -1.0, 1e9, std::nan("")})
    EXPECT_TRUE(contains(usage(request(seconds)), "--seconds"));
  GenerateRequest r = request(1);
  r.joints = {kKnee};
  EXPECT_TRUE(contains(usage(r), "--prompt"));
  r.prompt = random_clip(8, 10);
  r.joints = {joint_index("head")};
  EXPECT_TRUE(contains(usage(r), "left_knee"));
  r.joints = {99};
  usage(r);
  r.joints = {kKnee};
  r.prompt_seconds = std::nan("");
  EXPECT_TRUE(contains(usage(r), "--prompt-seconds"));
  r.prompt_seconds = -1;
  usage(r);
  r = request(1);
  r.sampling.temperature = 0;
  EXPECT_TRUE(contains(usage(r), "temperature"));
}

TEST_F(Dance, OddPromptsAreDataErrors) {
  GenerateRequest r = request(1);
  r.prompt = random_clip(9, 10);
  r.prompt->poses(3, 5) = std::nan("");
  EXPECT_TRUE(contains(data(r), "frame 3"));
  r.prompt = random_clip(9, 10);
  r.prompt->fps = 0;
  data(r);
  r.prompt->fps = 30;
  r.prompt->trans(2, 1) = std::numeric_limits<double>::infinity();
  data(r);
  r.prompt = Clip();
  data(r);
}

TEST_F(Dance, AnotherTokenizerIsRefused) {
  const auto refused = [](const StoredModel& model) {
    return refusal<DataError>([&] { Generator(model, "m"); });
  };
  StoredModel bad = model_;
  bad.tokenizer["bins"] = 17;
  refused(bad);
  bad = model_;
  bad.description.tokenizer_fingerprint = "0123456789abcdef";
  EXPECT_TRUE(contains(refused(bad), "tokenizer.json"));
  bad = model_;
  Tokenizer more = Tokenizer::from_json(bad.tokenizer, "t");
  more.add_label_values("genre", {"waack"});
  bad.tokenizer = more.to_json();
  EXPECT_TRUE(contains(refused(bad), "tokenizer.json"));
  for (const bool channels : {true, false}) {  // a config that tells another stream
    bad = model_;
    (channels ? bad.description.shape.channels : bad.description.shape.bins) -= 1;
    bad.tensors = random_weights(bad.description, 2);
    EXPECT_TRUE(contains(refused(bad), "tokenizer.json"));
  }
}

TEST(FrozenShare, CountsFramesInWhichNothingMovesMoreThanOneBin) {
  TokenizerConfig config;
  config.bins = 100;
  config.joints = {"left_knee"};
  config.root = "absolute";
  const Tokenizer tokenizer = Tokenizer::fit(config, {random_clip(10, 30)});
  const auto ids = [](const std::vector<std::vector<std::int32_t>>& frames) {
    std::vector<std::int32_t> all;
    for (const auto& frame : frames) {
      for (const std::int32_t bin : frame) all.push_back(Tokenizer::kFirstBin + bin);
      all.push_back(Tokenizer::kSeparator);
    }
    return all;
  };
  // The root's translation does not count; a slow drift does not either.
  EXPECT_EQ(frozen_share(ids({{5, 5, 5, 1, 1, 1},
                              {5, 6, 4, 50, 9, 9},
                              {6, 6, 4, 1, 1, 1},
                              {8, 6, 4, 1, 1, 1},
                              {8, 6, 2, 1, 1, 1}}),
                         tokenizer),
            0.5);
  EXPECT_EQ(frozen_share(ids({{5, 5, 5, 1, 1, 1}}), tokenizer), 0);
  EXPECT_EQ(frozen_share({}, tokenizer), 0);
  EXPECT_EQ(frozen_share(ids({{1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, 1}}), tokenizer), 1);
}

}  // namespace

}  // namespace mocaplm::generator_test
