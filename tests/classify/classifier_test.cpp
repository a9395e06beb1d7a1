// The classification tokens, and a training of seconds on motion that is easy to tell apart.
#include "classify/classifier.h"

#include <gtest/gtest.h>

#include "classify/predict.h"
#include "classify/train.h"
#include "common/temporary_folder.h"
#include "model/transformer/transformer.h"
#include "motion/formats/npz.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "support/small_models.h"
#include "train/trainer.h"

namespace fs = std::filesystem;

namespace mocaplm::classifier_test {
namespace {

class ClassTokens : public ::testing::Test {
 protected:
  ClassTokens() {
    at::manual_seed(3);
    for (at::Tensor p : classifier_.parameters()) {
      const at::NoGradGuard no_grad;
      p.normal_(0, 0.3);
    }
    classifier_.eval();
  }
  Batch batch(const std::vector<std::int32_t>& ids) const {
    return stack({window_input(description_, {2}, ids, 0, ids.size())});
  }
  std::vector<std::int32_t> stream(std::uint64_t seed) const {
    Random random(seed);
    return random_stream(description_.shape, 5, random);
  }
  ModelDescription description_ = small_description();
  std::shared_ptr<Transformer> transformer_ = std::make_shared<Transformer>(description_);
  Classifier classifier_{transformer_, {{"genre", {"a", "b", "c"}}, {"hand", {"l", "r"}}}};
};

TEST_F(ClassTokens, OneRowOfLogitsATask) {
  const Classifier::Output out = classifier_.forward(batch(stream(1)));
  ASSERT_EQ(out.logits.size(), 2u);
  EXPECT_EQ(out.logits[0].sizes(), (std::vector<std::int64_t>{1, 3}));
  EXPECT_EQ(out.logits[1].sizes(), (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(out.hidden.sizes(), (std::vector<std::int64_t>{1, 21, 16}));
}

TEST_F(ClassTokens, TheMotionDoesNotSeeThem) {
  const at::NoGradGuard no_grad;
  const Batch one = batch(stream(1));
  const at::Tensor with = classifier_.forward(one).hidden, without = transformer_->hidden(one);
  EXPECT_LT((with - without).abs().max().item<float>(), 1e-5);
  for (const auto& item : classifier_.named_parameters(false))
    if (item.key() == "class_embedding") item.value().mul_(-5);
  EXPECT_LT((classifier_.forward(one).hidden - without).abs().max().item<float>(), 1e-5);
}

TEST_F(ClassTokens, TheySeeEveryPosition) {
  const at::NoGradGuard no_grad;
  const std::vector<std::int32_t> ids = stream(1);
  const Classifier::Output before = classifier_.forward(batch(ids));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i % 4 == 3) continue;  // a separator
    std::vector<std::int32_t> changed = ids;
    changed[i] = 4 + (changed[i] - 4 + 5) % 11;
    const Classifier::Output after = classifier_.forward(batch(changed));
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_GT((after.logits[k] - before.logits[k]).abs().max().item<float>(), 1e-6)
          << "token " << i << ", task " << k;
  }
}

TEST_F(ClassTokens, TheLanguageLossAndEveryTaskReachTheTransformer) {
  for (std::size_t k = 0; k < 2; ++k) {
    classifier_.zero_grad();
    classifier_.forward(batch(stream(2))).logits[k].square().sum().backward();
    for (const auto& item : transformer_->named_parameters())
      if (item.key() == "token_embedding") {
        EXPECT_GT(item.value().grad().abs().max().item<float>(), 0) << k;
      }
  }
}

// Two classes: the arm swings fast or it hardly moves, around the same poses.
void write_swings(const fs::path& folder) {
  std::vector<SmallClip> clips;
  const char* splits[] = {"train", "train", "train", "train", "validation", "test", "test"};
  for (int i = 0; i < 7; ++i)
    for (const char* style : {"calm", "wild"})
      clips.push_back({style + std::to_string(i), splits[i], 60, {{"style", style}}});
  const Dataset dataset = write_dataset(folder, clips);
  Random random(5);
  for (const DatasetEntry& entry : dataset.entries) {
    Clip clip = load_clip(dataset, entry);
    const double reach = entry.labels.at("style") == "wild" ? 1.0 : 0.1,
                 phase = 6 * random.uniform();
    clip.poses.setZero();
    for (Eigen::Index t = 0; t < clip.frames(); ++t)
      clip.poses(t, 3 * 19) = reach * std::sin(phase + 0.9 * static_cast<double>(t));
    write_npz(folder / entry.file, clip);
  }
}

TEST(Classify, TellsClearlyDifferentClassesApart) {
  TemporaryFolder folder;
  write_swings(folder / "data");
  TrainOptions train_options;
  train_options.config.tokenizer.bins = 40;
  train_options.config.tokenizer.joints = {"right_elbow"};
  train_options.config.tokenizer.root = "none";
  ModelConfig& model = train_options.config.model;
  model.n_layer = 1, model.n_head = 2, model.n_embd = 32, model.block_size = 64, model.reach = 8;
  TrainConfig& training = train_options.config.train;
  training.steps = 20, training.batch_size = training.micro_batch = 4, training.warmup = 2;
  training.precision = "f32";
  train_options.data = folder / "data";
  train_options.out = folder / "run";
  train_options.device = "cpu";
  train_options.threads = 1;
  train(train_options);

  ClassifyOptions options;
  options.model = folder / "run";
  options.data = folder / "data";
  options.out = folder / "classifier";
  options.device = "cpu";
  options.threads = 1;
  options.config.steps = 60;
  options.config.learning_rate = 3e-3;
  options.config.validate_every = 20;
  options.config.precision = "f32";
  const ClassifyResult result = classify(options);
  ASSERT_EQ(result.methods.size(), 3u);
  EXPECT_DOUBLE_EQ(result.methods[0].tasks[0].window_accuracy, 0.5);
  EXPECT_GT(result.methods[2].tasks[0].window_accuracy, 0.9);
  EXPECT_EQ(result.methods[2].tasks[0].clip_accuracy, 1);
  EXPECT_EQ(result.methods[2].tasks[0].clips, 4);
  EXPECT_EQ(load_description(folder / "classifier").classes[0].first, "style");
  EXPECT_TRUE(fs::exists(folder / "classifier" / "classification.json"));

  // The kept classifier says the same of the test clips' files.
  PredictOptions predict;
  predict.model = folder / "classifier";
  predict.precision = "f32";
  predict.threads = 1;
  const Dataset dataset = load_dataset(folder / "data");
  std::vector<std::string> styles;
  for (const DatasetEntry& entry : dataset.split("test")) {
    predict.clips.push_back((folder / "data" / entry.file).string());
    styles.push_back(entry.labels.at("style"));
  }
  const Json rows = predict_table(predict).json().at("rows");
  ASSERT_EQ(rows.size(), styles.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("value"), styles[i]);
    EXPECT_NEAR(rows[i].at("%").get<double>() + rows[i].at("% of next").get<double>(), 100, 1e-4);
  }
  predict.model = folder / "run";
  EXPECT_NE(refusal<UsageError>([&] { predict_table(predict); }).find("no classifier"),
            std::string::npos);
}

}  // namespace
}  // namespace mocaplm::classifier_test
