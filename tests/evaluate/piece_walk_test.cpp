// Models of pieces from end to end: SentencePiece (in a process of its own), training, generation
// and bits per frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/temporary_folder.h"
#include "evaluate/evaluate.h"
#include "evaluate/likelihood.h"
#include "generate/generator.h"
#include "generate/piece_decoder.h"
#include "support/piece_models.h"
#include "support/random_model.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "support/small_models.h"
#include "train/setup.h"
#include "train/stream_shape.h"

namespace fs = std::filesystem;

namespace mocaplm::piece_walk_test {

namespace {

// One clip, which is training, validation and test split alike.
class PieceWalk : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_dataset(data(), {{"a", "train", 60, {{"style", "calm"}}, 20, 5},
                           {"b", "validation", 60, {{"style", "calm"}}, 20, 5},
                           {"c", "test", 60, {{"style", "calm"}}, 20, 5}});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static fs::path data() { return *folder_ / "data"; }

  static TrainOptions options(const std::string& out, bool unigram = false) {
    TrainOptions o;
    o.config.tokenizer.bins = 24;
    o.config.tokenizer.joints = {"left_knee", "right_elbow"};
    o.config.tokenizer.root = "none";
    (unigram ? o.config.pieces.unigram : o.config.pieces.bpe) = 70;
    o.config.model.n_layer = 2;
    o.config.model.n_head = 2;
    o.config.model.n_embd = 48;
    o.config.model.block_size = 256;
    o.config.model.dropout = 0;
    o.config.model.reach = 6;
    o.config.model.output = "absolute";
    o.config.train.steps = 90;
    o.config.train.batch_size = o.config.train.micro_batch = 2;
    o.config.train.warmup = 10;
    o.config.train.validate_every = 90;
    o.config.train.validation_windows = 4;
    o.config.train.learning_rate = 4e-3;
    o.config.train.precision = "f32";
    o.data = data();
    o.out = *folder_ / out;
    o.device = "cpu";
    o.threads = 1;
    o.tokenize_program = MOCAPLM_BINARY_DIR "/mocaplm";
    return o;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};

std::unique_ptr<TemporaryFolder> PieceWalk::folder_;

TEST_F(PieceWalk, AModelThatHasLearntOneClipByHeartSaysIt) {
  const TrainOptions o = options("heart");
  const TrainResult trained = train(o);
  const StoredModel stored = load_model(o.out);
  ASSERT_TRUE(stored.description.has_pieces());
  EXPECT_EQ(static_cast<double>(trained.parameters), parameter_count(stored.description));
  Generator generator(stored, "run", {Precision::f32, 0, 1});
  const Tokenizer& tokenizer = generator.tokenizer();
  const Dataset dataset = load_dataset(data());
  const Clip clip = load_clip(dataset, dataset.split("test")[0]);
  GenerateRequest request;
  request.prompt = clip;
  request.prompt_seconds = 0.5;
  request.seconds = 2.5;
  request.sampling.strategy = "greedy";
  const Clip said = generator.generate(request).clip;
  EXPECT_EQ(tokenizer.encode(said).ids, tokenizer.encode(clip).ids);

  EvaluateOptions evaluate;
  evaluate.model = o.out;
  evaluate.data = data();
  evaluate.device = "cpu";
  evaluate.threads = 1;
  evaluate.precision = "f32";
  const SplitBits bits = split_bits(evaluate);
  const BitCount& model = bits.groups.at("").model;
  EXPECT_EQ(model.frames, 60);
  EXPECT_LT(model.per_frame(0, 6), 6) << "known by heart";
  // Training's bits count the separators, too, and other windows.
  EXPECT_NEAR(model.per_frame(), trained.best_bits_per_frame, 3);
  const std::string table = evaluate_tables(evaluate)[0].text();
  EXPECT_PRED2(contains, table, "upper bound");
  evaluate.engine = "f32";
  EXPECT_PRED2(contains, refusal<UsageError>([&] { split_bits(evaluate); }), "pieces");
}

TEST_F(PieceWalk, IsTrainedOnFromAndResumed) {
  TrainOptions o = options("first", true);
  o.config.train.steps = 6;
  o.config.train.validate_every = 3;
  o.config.train.save_every = 3;
  o.stop_after_step = 3;
  train(o);
  TrainOptions rest;
  rest.out = o.out;
  rest.resume = true;
  rest.device = "cpu";
  rest.threads = 1;
  EXPECT_EQ(train(rest).steps, 3);
  const StoredModel first = load_model(o.out);
  EXPECT_EQ(load_json(o.out / "settings.json").at("config").at("pieces").at("unigram"), 70);
  TrainOptions tuned = options("tuned");
  tuned.from = o.out;
  tuned.config.train.steps = 2;
  tuned.tokenize_program = "/nowhere";  // nothing is learnt anew
  train(tuned);
  const StoredModel second = load_model(tuned.out);
  EXPECT_EQ(second.pieces, first.pieces);
  EXPECT_EQ(second.description.pieces_fingerprint, first.description.pieces_fingerprint);
  EXPECT_EQ(second.description.conditions, std::vector<std::string>{"style"});
  EXPECT_EQ(second.description.shape.vocabulary, first.description.shape.vocabulary + 1);
  GenerateRequest request;
  request.seconds = 1;
  request.labels = {{"style", "calm"}};
  EXPECT_EQ(Generator(second, "run").generate(request).clip.frames(), 20);
}

TEST_F(PieceWalk, RefusesWhatCannotBe) {
  const auto says = [](const TrainOptions& o) {
    return refusal<UsageError>([&] { set_up_training(o); });
  };
  TrainOptions o = options("bad");
  o.config.model.architecture = "frames";
  EXPECT_PRED2(contains, says(o), "architecture flat");
  o = options("bad");
  o.config.pieces.unigram = 100;
  EXPECT_PRED2(contains, says(o), "give one");
  o = options("bad");
  o.config.pieces.bpe = 5;
  EXPECT_PRED2(contains, says(o), "5 pieces");
  o = options("bad");
  o.config.train.joint_subset = 0.5;
  EXPECT_PRED2(contains, says(o), "joint_subset");
}

// Windows and targets of a corpus in pieces.
TEST_F(PieceWalk, WindowsBeginWithFramesAndTargetsAreTheNextPieces) {
  TrainOptions o = options("windows");
  o.config.model.block_size = 40;
  const TrainSetup setup = set_up_training(o);
  const EncodedClip& clip = setup.train.clips[0];
  const std::vector<std::int32_t>& tokens = clip.pieces.tokens;
  ASSERT_EQ(clip.pieces.frame_count(), 60u);
  EXPECT_EQ(predicted_per_frame(setup.train, setup.description),
            static_cast<double>(tokens.size()) / 60);
  EXPECT_LT(tokens.size(), clip.ids.size());
  const WindowSampler sampler(setup.train, setup.description);
  Random random(1);
  std::size_t latest = 0;
  for (int i = 0; i < 600; ++i) {
    const Window w = sampler.draw(random, {});
    ASSERT_EQ(w.input.size(), 40u);
    ASSERT_EQ(w.size, 40u) << "a window that could be full is full";
    const std::size_t first = clip.pieces.frames[w.first_frame];
    for (std::size_t p = 1; p < 40; ++p) EXPECT_EQ(w.input.token[p], tokens[first + p - 1]);
    for (std::size_t p = 0; p < 40; ++p)
      EXPECT_EQ(w.target[p], first + p < tokens.size() ? tokens[first + p] : -1);
    EXPECT_LE(clip.pieces.frames[w.first_frame + w.frames] - first, 39u);
    latest = std::max(latest, w.first_frame);
  }
  EXPECT_GT(tokens.size() - clip.pieces.frames[latest + 1], 0u);
  EXPECT_LT(tokens.size() - clip.pieces.frames[latest + 1], 39u) << "the last start is drawn, too";
  std::size_t frames = 0;
  for (const Window& w : even_windows(setup.train, setup.description, 100)) {
    EXPECT_EQ(w.first_frame, frames);
    frames += w.frames;
  }
  EXPECT_GE(frames, 58u);
}

// Against the definition, a window at a time.
TEST(ScorePieceClips, IsTheSumOfThePiecesOfEachFrame) {
  TokenizerConfig config;
  config.bins = 16;
  config.joints = {"left_knee"};
  config.root = "none";
  const Tokenizer tokenizer = Tokenizer::fit(config, {});
  const std::string bytes =
      random_piece_bytes(tokenizer, {tokenizer.encode(random_clip(1, 100)).ids}, 100);
  const PieceVocabulary pieces(bytes, tokenizer, "pieces");
  ModelDescription d = small_description();
  d.shape = stream_shape(tokenizer, pieces);
  d.pieces_fingerprint = pieces.fingerprint();
  const auto model = random_model(d, 11);
  std::vector<ScoredClip> clips;
  for (const Eigen::Index frames : {1, 3, 5, 8, 30}) {
    ScoredClip clip;
    clip.ids = tokenizer.encode(random_clip(static_cast<std::uint64_t>(frames), frames)).ids;
    clip.prefix = {Tokenizer::kStart};
    clip.pieces = pieces.encode(clip.ids);
    clips.push_back(clip);
  }
  const std::vector<BitCount> counts = score_clips(*model, clips, 3);
  const at::NoGradGuard no_grad;
  constexpr std::size_t kRoom = 23;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const PieceStream& stream = clips[c].pieces;
    double sum = 0;
    std::size_t first = 0, last = 0;  // frames of the window
    for (std::size_t f = 0; f < stream.frame_count(); ++f) {
      if (stream.frames[f + 1] - stream.frames[first] > kRoom) {  // a new window, half full
        last = f;
        while (stream.frames[last] - stream.frames[first] > kRoom / 2) ++first;
      }
      const std::size_t begin = stream.frames[first];
      const Batch batch = stack(
          {piece_window_input(d, clips[c].prefix, {clips[c].ids, stream.tokens, stream.starts},
                              begin, stream.frames[f + 1] - begin)});
      const at::Tensor logs =
          at::log_softmax(model->logits(model->hidden(batch), batch)[0].to(at::kDouble), -1);
      for (std::size_t t = stream.frames[f]; t < stream.frames[f + 1]; ++t)
        sum -= logs[static_cast<std::int64_t>(t - begin)][stream.tokens[t]].item<double>() /
               std::log(2.0);
    }
    EXPECT_EQ(counts[c].frames, static_cast<std::int64_t>(stream.frame_count()));
    ASSERT_EQ(counts[c].bits.size(), 4u);
    double total = 0;
    for (const double bits : counts[c].bits) total += bits;
    EXPECT_NEAR(total, sum, 1e-3 + 1e-4 * sum) << "clip " << c;
  }
}

}  // namespace

}  // namespace mocaplm::piece_walk_test
