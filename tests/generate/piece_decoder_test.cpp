// Models of pieces: the decoder against the trainable transformer, and dances that are whole frames
// whatever the prompt gives.
#include "generate/piece_decoder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "generate/generator.h"
#include "model/transformer/weights.h"
#include "motion/skeleton.h"
#include "support/piece_models.h"
#include "support/refusal.h"
#include "support/small_models.h"
#include "tokenizer/random_clips.h"
#include "train/stream_shape.h"

namespace mocaplm::piece_decoder_test {

namespace {

const int kKnee = joint_index("left_knee"), kElbow = joint_index("right_elbow");

// 2 joints and the root: 9 channels; a context of 5 frames of single characters or more of pieces.
StoredModel piece_model(const std::string& position = "custom",
                        const std::string& output = "extrapolation", int count = 400,
                        const std::string& root = "steps") {
  TokenizerConfig config;
  config.bins = 16;
  config.joints = {"left_knee", "right_elbow"};
  config.root = root;
  Tokenizer tokenizer = Tokenizer::fit(config, {random_clip(1, 100)});
  StoredModel model;
  model.pieces = random_piece_bytes(tokenizer, {tokenizer.encode(random_clip(1, 100)).ids}, count);
  const PieceVocabulary pieces(model.pieces, tokenizer, "pieces");
  tokenizer.add_label_values("style", {"calm", "wild"});
  model.description = small_description(position, output);
  model.description.config.block_size = 52;
  model.description.shape = stream_shape(tokenizer, pieces);
  model.description.tokenizer_fingerprint = tokenizer.fingerprint();
  model.description.pieces_fingerprint = pieces.fingerprint();
  model.description.conditions = {"style"};
  model.tensors = random_weights(model.description, 2);
  model.tokenizer = tokenizer.to_json();
  return model;
}

std::vector<float> full_logits(LanguageModel& model, const ModelInput& input) {
  const at::NoGradGuard no_grad;
  const Batch batch = stack({input});
  const at::Tensor logits = model.logits(model.hidden(batch), batch)[0][-1].contiguous();
  return {logits.data_ptr<float>(), logits.data_ptr<float>() + logits.numel()};
}

void expect_near(const std::vector<float>& got, const std::vector<float>& expected) {
  ASSERT_EQ(got.size(), expected.size());
  float worst = 0;
  for (std::size_t i = 0; i < got.size(); ++i)
    worst = std::max(worst, std::abs(got[i] - expected[i]));
  EXPECT_LT(worst, 1e-3f);
}

// Token by token; before each one the window that the decoder should have is built anew.
TEST(PieceDecoder, GivesTheTransformersLogitsAlsoPastTheContext) {
  for (const char* position : {"custom", "absolute"})
    for (const char* output : {"extrapolation", "absolute"}) {
      const StoredModel stored = piece_model(position, output);
      const ModelDescription& d = stored.description;
      const Tokenizer tokenizer = Tokenizer::from_json(stored.tokenizer, "t");
      const PieceVocabulary pieces = stored_pieces(stored, "m");
      const auto model = load_transformer(stored, "m");
      model->eval();
      const PieceStream stream = pieces.encode(tokenizer.encode(random_clip(1, 30)).ids);
      const std::vector<std::int32_t> ids = tokenizer.encode(random_clip(1, 30)).ids;
      const std::vector<std::int32_t> prefix = {Tokenizer::kStart, Tokenizer::kMask};
      ASSERT_LT(stream.tokens.size(), 0.9 * static_cast<double>(ids.size()));
      PieceDecoder decoder(stored, "m", {Precision::f32, 1, 1});
      decoder.begin(0, prefix, {});
      std::size_t first = 0, slides = 0;
      for (std::size_t i = 0; i < stream.tokens.size(); ++i) {
        // What comes after must not matter: the window is built from the stream so far.
        const std::vector<std::int32_t> so_far(
            ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(stream.starts[i]));
        const ModelInput input =
            piece_window_input(d, prefix, {so_far, stream.tokens, stream.starts}, first, i - first);
        const ModelInput whole =
            piece_window_input(d, prefix, {ids, stream.tokens, stream.starts}, first, i - first);
        EXPECT_EQ(input.velocity, whole.velocity);
        EXPECT_EQ(input.centre, whole.centre);
        if (i % 5 == 0) expect_near(decoder.logits({0})[0], full_logits(*model, input));
        if (prefix.size() + i - first >= static_cast<std::size_t>(d.config.block_size)) {
          // The push slides: the frames that begin in the younger half of the room are left.
          ++slides;
          const std::size_t room = static_cast<std::size_t>(d.config.block_size) - prefix.size();
          std::size_t f = 0;
          while (i - stream.frames[f] > room / 2) ++f;
          first = stream.frames[f];
        }
        decoder.push(0, stream.tokens[i]);
      }
      EXPECT_GE(slides, 2u);
    }
}

TEST(PieceInput, OneCharacterIsWhatItWasWithoutPieces) {
  ModelDescription d = small_description();
  Random random(3);
  const std::vector<std::int32_t> ids = random_stream(d.shape, 8, random);
  const ModelInput plain = window_input(d, {2}, ids, 4, 20);
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i <= ids.size(); ++i) starts.push_back(i);
  d.shape.pieces = 5;
  d.shape.longest = 3;
  const ModelInput single = piece_window_input(d, {2}, {ids, ids, starts}, 4, 20);
  for (const auto member :
       {&ModelInput::token, &ModelInput::frame, &ModelInput::channel, &ModelInput::centre,
        &ModelInput::surprise, &ModelInput::velocity, &ModelInput::last_surprise})
    EXPECT_EQ(plain.*member, single.*member);
  // A piece of channels 1 and 2 of a frame of 3: what is told of the next is told of the separator.
  ModelInput input;
  append_piece(input, d, ids, 0, 9, 99, 2);
  EXPECT_EQ(input.token, std::vector<std::int32_t>{99});
  EXPECT_EQ(input.frame, std::vector<std::int32_t>{3});
  EXPECT_EQ(input.channel, std::vector<std::int32_t>{1 + 5});
  EXPECT_EQ(input.centre, std::vector<std::int32_t>{kNoCentre});
}

class PieceDance : public testing::Test {
 protected:
  static GenerateRequest request(double seconds) {
    GenerateRequest r;
    r.seconds = seconds;
    r.sampling.top_p = 1;
    return r;
  }
  StoredModel model_ = piece_model();
  Generator generator_{model_, "m", {Precision::f32, 1, 3}};
};

// Random weights choose anything that is allowed: whole frames come of it all the same.
TEST_F(PieceDance, IsWholeFramesThatKeepThePrompt) {
  const auto joint = [](const Clip& clip, int index) {
    return clip.poses.middleCols(3 * index, 3);
  };
  GenerateRequest r = request(3);
  EXPECT_EQ(generator_.generate(r).clip.frames(), 60);
  r.prompt = random_clip(3, 25);
  const GenerateResult whole = generator_.generate(r);
  ASSERT_EQ(whole.clip.frames(), 85);
  for (const int j : {kKnee, kElbow})
    EXPECT_EQ(joint(whole.clip, j).topRows(25), joint(*r.prompt, j));
  for (const int j : {kKnee, kElbow}) {
    r.joints = {j};
    r.labels = {{"style", "wild"}};
    const GenerateResult some = generator_.generate(r);
    EXPECT_EQ(some.clip.frames(), 60);
    EXPECT_EQ(joint(some.clip, j).topRows(25), joint(*r.prompt, j));
    const int other = kKnee + kElbow - j;
    EXPECT_GT((joint(some.clip, other).topRows(25) - joint(*r.prompt, other)).norm(), 1);
  }
}

// Also the bins of what is prompted are the prompt's own (result() puts the prompt itself there, so
// the streamed root is looked at: it goes with the pelvis, or the knee alone is told).
TEST_F(PieceDance, AgreesWithThePromptInEveryToken) {
  const StoredModel model = piece_model("custom", "absolute", 400, "absolute");
  Generator generator(model, "m", {Precision::f32, 1, 1});
  const Tokenizer& tokenizer = generator.tokenizer();
  GenerateRequest r = request(1);
  const std::vector<std::int32_t> given = tokenizer.encode(random_clip(9, 20)).ids;
  r.prompt = tokenizer.decode(given, "prompt");
  r.joints = {kElbow};
  const std::vector<std::int32_t> ids = tokenizer.encode(generator.generate(r).clip).ids;
  ASSERT_EQ(ids.size(), given.size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (tokenizer.channel_joint(static_cast<int>(i % 10 % 9)) == kElbow && i % 10 < 6)
      EXPECT_EQ(ids[i], given[i]) << i;
    else
      same += ids[i] == given[i];
  EXPECT_LT(same, ids.size() / 2);
}

TEST_F(PieceDance, ManyAtOnceAreWhatEachIsAlone) {
  std::vector<GenerateRequest> requests;
  for (int i = 0; i < 5; ++i) {
    GenerateRequest r = request(0.5 + 0.4 * i);
    r.sampling.seed = i;
    if (i % 2 == 1) r.prompt = random_clip(static_cast<std::uint64_t>(20 + i), 15);
    if (i == 3) r.joints = {kKnee};
    requests.push_back(r);
  }
  Generator alone(model_, "m", {Precision::f32, 1, 1});
  const auto results = generator_.generate(requests);
  for (std::size_t i = 0; i < requests.size(); ++i)
    EXPECT_EQ(results[i].clip.poses, alone.generate(requests[i]).clip.poses) << i;
}

TEST_F(PieceDance, OtherPiecesAreRefused) {
  const auto refused = [](const StoredModel& model) {
    return refusal<DataError>([&] { Generator(model, "m"); });
  };
  StoredModel bad = model_;
  bad.pieces = piece_model("custom", "extrapolation", 300).pieces;
  EXPECT_PRED2(contains, refused(bad), "is not what this model was trained with");
  bad.pieces.resize(bad.pieces.size() / 2);
  EXPECT_PRED2(contains, refused(bad), "pieces.model");
  bad = model_;
  --bad.description.shape.pieces;
  bad.tensors = random_weights(bad.description, 2);
  EXPECT_PRED2(contains, refused(bad), "config.json says");
  bad = model_;
  bad.description.config.architecture = "frames";
  EXPECT_PRED2(contains, refusal<UsageError>([&] { check_model(bad.description); }),
               "architecture flat");
  bad.description.config.architecture = "flat";
  bad.description.config.objective = "masked";
  EXPECT_PRED2(contains, refusal<UsageError>([&] { check_model(bad.description); }), "causal");
}

TEST_F(PieceDance, TheConfigComesBack) {
  const ModelDescription back = model_from_json(to_json(model_.description), "config.json");
  EXPECT_EQ(back.shape.pieces, model_.description.shape.pieces);
  EXPECT_EQ(back.shape.longest, model_.description.shape.longest);
  EXPECT_EQ(back.pieces_fingerprint, model_.description.pieces_fingerprint);
  double held = 0;
  for (const auto& item : model_.tensors) held += static_cast<double>(item.second.size());
  EXPECT_EQ(parameter_count(back), held);
}

}  // namespace

}  // namespace mocaplm::piece_decoder_test
