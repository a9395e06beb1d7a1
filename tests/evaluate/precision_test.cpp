// What the engine's lower precisions cost a trained model on clips that it has not seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/temporary_folder.h"
#include "evaluate/likelihood.h"
#include "generate/engine.h"
#include "motion/synth.h"
#include "train/trainer.h"

namespace fs = std::filesystem;

namespace mocaplm::precision_test {

namespace {

constexpr std::size_t kContext = 6;  // frames before the greedy stream begins

// A small model of procedural dances, trained until it predicts movement.
class TrainedModel : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    SynthConfig dances;
    dances.genres = {"WA", "LO"};
    dances.choreographies = 2;
    dances.seconds = 8;
    write_dances(dances, *folder_ / "dances", false, 0);
    TrainOptions options;
    options.config.tokenizer.bins = 120;
    options.config.tokenizer.joints = {"left_shoulder", "left_elbow", "right_knee"};
    options.config.model.n_layer = 2;
    options.config.model.n_head = 2;
    options.config.model.n_embd = 64;
    options.config.model.block_size = 208;
    options.config.model.dropout = 0;
    options.config.train.steps = 150;
    options.config.train.batch_size = options.config.train.micro_batch = 8;
    options.config.train.warmup = 20;
    options.config.train.learning_rate = 3e-3;
    options.config.train.validate_every = 150;
    options.config.train.conditions = {"none"};
    options.data = *folder_ / "dances";
    options.out = *folder_ / "run";
    options.device = "cpu";
    trained_ = train(options).best_bits_per_frame;
    stored_ = std::make_unique<StoredModel>(load_model(options.out));
  }
  static void TearDownTestSuite() { folder_.reset(), stored_.reset(); }

  static std::vector<ScoredClip> held_out() {
    const Tokenizer tokenizer =
        Tokenizer::of_model(stored_->tokenizer, stored_->description.tokenizer_fingerprint, "run");
    const Dataset dataset = load_dataset(*folder_ / "dances");
    std::vector<ScoredClip> clips;
    for (const DatasetEntry& entry : dataset.entries)
      if (entry.split == "test")
        clips.push_back({tokenizer.encode(tokenizer.at_rate(load_clip(dataset, entry))).ids,
                         {Tokenizer::kStart}});
    return clips;
  }

  static double bits_per_frame(Precision precision, const std::vector<ScoredClip>& clips) {
    const auto decoder = make_decoder(*stored_, "run", {precision, 0, 8});
    BitCount all;
    for (const BitCount& one : score_clips(*decoder, clips)) all.add(one);
    return all.per_frame(0, static_cast<int>(stored_->description.shape.channels));
  }

  // The most likely tokens, one after the other, behind the first frames of a clip.
  static std::vector<std::int32_t> greedy(Precision precision, const ScoredClip& clip) {
    const StreamShape& shape = stored_->description.shape;
    const auto per_frame = static_cast<std::size_t>(shape.tokens_per_frame());
    Engine engine(*stored_, "run", {precision, 0, 1});
    std::vector<std::int32_t> ids(
        clip.ids.begin(), clip.ids.begin() + static_cast<std::ptrdiff_t>(kContext * per_frame));
    engine.feed_silently(window_input(stored_->description, clip.prefix, ids, 0, ids.size() - 1));
    while (engine.length() + 1 < engine.capacity()) {
      ModelInput next;
      append_stream(next, stored_->description, ids, 0, ids.size() - 1);
      const std::vector<float>& logits = engine.feed(next);
      ids.push_back(ids.size() % per_frame + 1 == per_frame
                        ? Tokenizer::kSeparator
                        : static_cast<std::int32_t>(
                              std::max_element(logits.begin() + shape.first_bin,
                                               logits.begin() + shape.first_bin + shape.bins) -
                              logits.begin()));
    }
    return ids;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static std::unique_ptr<StoredModel> stored_;
  static double trained_;
};

std::unique_ptr<TemporaryFolder> TrainedModel::folder_;
std::unique_ptr<StoredModel> TrainedModel::stored_;
double TrainedModel::trained_ = 0;

TEST_F(TrainedModel, LosesAlmostNothingInLowerPrecision) {
  const std::vector<ScoredClip> clips = held_out();
  ASSERT_GT(clips.size(), 3u);
  const double f32 = bits_per_frame(Precision::f32, clips);
  // It has learnt: 12 channels of 120 bins would cost 83 bits.
  EXPECT_LT(f32, 45) << "validation " << trained_;
  EXPECT_NEAR(bits_per_frame(Precision::bf16, clips) / f32, 1, 0.001);
  EXPECT_NEAR(bits_per_frame(Precision::int8, clips) / f32, 1, 0.005);
}

TEST_F(TrainedModel, GreedyStreamsAgreeForLong) {
  for (const Precision precision : {Precision::bf16, Precision::int8}) {
    std::size_t same = 0, all = 0;
    for (const ScoredClip& clip : held_out()) {
      const auto expected = greedy(Precision::f32, clip), got = greedy(precision, clip);
      ASSERT_EQ(got.size(), expected.size());
      const auto difference = std::mismatch(got.begin(), got.end(), expected.begin());
      same += static_cast<std::size_t>(difference.first - got.begin());
      all += got.size();
    }
    // Streams part for good where two tokens are all but equally likely.
    EXPECT_GT(static_cast<double>(same),
              (precision == Precision::bf16 ? 0.8 : 0.5) * static_cast<double>(all))
        << to_string(precision) << ": " << same << " of " << all;
  }
}

}  // namespace

}  // namespace mocaplm::precision_test
