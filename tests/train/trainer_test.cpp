// Training runs of a tiny model: learning, stopping and going on, fine-tuning, refusals.
#include "train/trainer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "model/transformer/setup.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "train/setup.h"

namespace fs = std::filesystem;

namespace mocaplm::trainer_test {

namespace {

class Training : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_dataset(data(), {{"a", "train", 80, {{"style", "calm"}}},
                           {"b", "train", 50, {{"style", "wild"}, {"dancer", "d1"}}},
                           {"c", "validation", 60, {{"style", "calm"}}}});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static fs::path data() { return *folder_ / "data"; }

  // 2 joints without the root: 7 tokens a frame, 13 frames a window.
  TrainOptions options(const std::string& out) const {
    TrainOptions o;
    o.config.tokenizer.bins = 24;
    o.config.tokenizer.joints = {"left_knee", "right_elbow"};
    o.config.tokenizer.root = "none";
    o.config.model.n_layer = 2;
    o.config.model.n_head = 2;
    o.config.model.n_embd = 32;
    o.config.model.block_size = 96;
    o.config.model.dropout = 0.1;
    o.config.model.reach = 6;
    o.config.train.steps = 12;
    o.config.train.batch_size = 4;
    o.config.train.micro_batch = 2;
    o.config.train.warmup = 2;
    o.config.train.validate_every = 6;
    o.config.train.save_every = 6;
    o.config.train.validation_windows = 4;
    o.config.train.learning_rate = 3e-3;
    o.config.train.precision = "f32";
    o.data = data();
    o.out = runs_ / out;
    o.device = "cpu";
    o.threads = 1;
    return o;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  TemporaryFolder runs_;
};

std::unique_ptr<TemporaryFolder> Training::folder_;

std::vector<Json> log_lines(const fs::path& run) {
  std::vector<Json> lines;
  const std::string text = read_file(run / "log.jsonl");
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
    lines.push_back(parse_json(text.substr(at, text.find('\n', at) - at), "log.jsonl"));
  return lines;
}

void expect_same_weights(const fs::path& a, const fs::path& b) {
  const StoredModel x = load_model(a), y = load_model(b);
  ASSERT_EQ(x.tensors.size(), y.tensors.size());
  for (const auto& [name, tensor] : x.tensors)
    EXPECT_EQ(tensor.values, y.tensors.at(name).values) << name;
}

TEST_F(Training, WritesARunThatLoads) {
  const TrainOptions o = options("run");
  const TrainResult result = train(o);
  EXPECT_EQ(result.steps, 12);
  EXPECT_EQ(result.model, o.out / "best");
  const StoredModel model = load_model(o.out);
  EXPECT_NO_THROW(load_transformer(model, "best"));
  EXPECT_EQ(static_cast<double>(result.parameters), parameter_count(model.description));
  EXPECT_EQ(model.self_test.size(), 2u);
  EXPECT_FALSE(model.description.procedural);
  EXPECT_TRUE(model.description.conditions.empty());
  const std::vector<Json> lines = log_lines(o.out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].at("step"), 6);
  EXPECT_EQ(lines[1].at("step"), 12);
  double best = 1e9;
  for (const Json& line : lines) {
    best = std::min(best, line.at("validation_bits_per_frame").get<double>());
    EXPECT_NEAR(line.at("validation_bits_per_frame").get<double>(),
                line.at("validation_loss").get<double>() * 7 / std::log(2), 1e-9);
  }
  EXPECT_NEAR(result.best_bits_per_frame, best, 1e-9);
  const RunConfig stored =
      run_config_from_json(load_json(o.out / "settings.json").at("config"), "settings.json");
  EXPECT_EQ(stored.train.steps, 12);
}

TEST_F(Training, AResumedRunEqualsOneThatNeverStopped) {
  for (const char* precision : {"f32", "bf16"}) {
    TrainOptions whole = options(std::string("whole-") + precision);
    whole.config.train.precision = precision;
    whole.config.train.conditions = {"style"};
    TrainOptions parts = whole;
    parts.out = runs_ / (std::string("parts-") + precision);
    train(whole);
    parts.stop_after_step = 7;  // between two saves and two validations
    EXPECT_EQ(train(parts).steps, 7);
    EXPECT_EQ(load_json(parts.out / "last" / "state.json").at("step"), 7);
    TrainOptions rest;  // everything else comes from the run itself
    rest.out = parts.out;
    rest.resume = true;
    rest.device = "cpu";
    rest.threads = 1;
    EXPECT_EQ(train(rest).steps, 5);
    expect_same_weights(whole.out / "last", parts.out / "last");
    expect_same_weights(whole.out / "best", parts.out / "best");
    const auto a = log_lines(whole.out), b = log_lines(parts.out);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      for (const char* key : {"step", "loss", "validation_loss", "learning_rate"})
        EXPECT_EQ(a[i].at(key), b[i].at(key)) << key << " of line " << i;
    EXPECT_EQ(train(rest).steps, 0);  // nothing is left to do, and nothing is lost
    expect_same_weights(whole.out / "last", parts.out / "last");
  }
}

TEST_F(Training, RepeatsBySeed) {
  TrainOptions a = options("a"), b = options("b"), c = options("c");
  for (TrainOptions* o : {&a, &b, &c}) o->config.train.steps = 3;
  c.config.train.seed = 2;
  train(a), train(b), train(c);
  expect_same_weights(a.out, b.out);
  EXPECT_NE(load_model(a.out).tensors.at("head.weight").values,
            load_model(c.out).tensors.at("head.weight").values);
}

TEST_F(Training, MicroBatchesOnlySaveMemory) {
  TrainOptions a = options("a"), b = options("b");
  for (TrainOptions* o : {&a, &b}) o->config.train.steps = 4, o->config.model.dropout = 0;
  b.config.train.micro_batch = 3;
  train(a), train(b);
  const StoredModel x = load_model(a.out / "last"), y = load_model(b.out / "last");
  for (const auto& [name, tensor] : x.tensors)
    for (std::size_t i = 0; i < tensor.values.size(); ++i)
      ASSERT_NEAR(tensor.values[i], y.tensors.at(name).values[i], 2e-4) << name;
}

// Mean cost of a token in nats when each channel's bins are coded by their own frequencies.
double order_zero(const std::vector<std::int32_t>& ids, std::size_t per_frame) {
  double nats = 0;
  for (std::size_t c = 0; c < per_frame; ++c) {
    std::map<std::int32_t, double> counts;
    for (std::size_t i = c; i < ids.size(); i += per_frame) ++counts[ids[i]];
    const double frames = static_cast<double>(ids.size() / per_frame);
    for (const auto& [id, count] : counts) nats -= count * std::log(count / frames);
  }
  return nats / static_cast<double>(ids.size());
}

TEST_F(Training, ABatchCanBeLearntByHeart) {
  const Dataset twice = write_dataset(
      runs_ / "twice", {{"a", "train", 13, {}, 20, 5}, {"b", "validation", 13, {}, 20, 5}});
  TrainOptions o = options("heart");
  o.data = twice.directory;
  o.config.model.dropout = 0;
  o.config.train.steps = 150;
  o.config.train.batch_size = 1;
  o.config.train.validate_every = o.config.train.save_every = 150;
  const TrainResult result = train(o);
  const Tokenizer tokenizer = Tokenizer::from_json(load_model(o.out).tokenizer, "t");
  const Clip clip = load_clip(twice, twice.entries[0]);
  ModelDescription shape;
  shape.shape.channels = 6;
  const double simple = bits_per_frame(order_zero(tokenizer.encode(clip).ids, 7), shape);
  std::printf("learnt by heart: %.3f bits a frame, order 0: %.2f\n", result.best_bits_per_frame,
              simple);
  EXPECT_LT(result.best_bits_per_frame, 0.1 * simple);
}

TEST_F(Training, FineTuningAddsConditionsAndStartsFromTheOldWeights) {
  TrainOptions base = options("base");
  train(base);
  TrainOptions tuned = options("tuned");
  tuned.from = base.out;
  tuned.config.model = ModelConfig();  // the stored model's own settings win
  tuned.config.tokenizer = TokenizerConfig();
  const StoredModel old = load_model(base.out);
  const TrainSetup setup = set_up_training(tuned);
  EXPECT_EQ(setup.description.conditions, std::vector<std::string>({"dancer", "style"}));
  EXPECT_EQ(setup.description.shape.vocabulary, old.description.shape.vocabulary + 3);
  EXPECT_EQ(setup.description.config.n_embd, 32);
  const TensorMap start = export_weights(*setup.model);
  for (const auto& [name, tensor] : old.tensors) {
    const std::vector<float>& now = start.at(name).values;
    ASSERT_GE(now.size(), tensor.values.size());
    EXPECT_TRUE(std::equal(tensor.values.begin(), tensor.values.end(), now.begin())) << name;
  }
  EXPECT_EQ(start.at("token_embedding").shape[0], old.tensors.at("token_embedding").shape[0] + 3);
  train(tuned);
  const StoredModel model = load_model(tuned.out);
  const Tokenizer tokenizer = Tokenizer::from_json(model.tokenizer, "t");
  EXPECT_TRUE(tokenizer.knows("style", "wild"));
  EXPECT_EQ(model.description.tokenizer_fingerprint, old.description.tokenizer_fingerprint);
  // And once more, without conditions.
  TrainOptions again = options("again");
  again.from = tuned.out;
  again.config.train.conditions = {"none"};
  train(again);
  EXPECT_TRUE(load_model(again.out).description.conditions.empty());
}

TEST_F(Training, ADivergedRunStopsAndLeavesALoadableCheckpoint) {
  TrainOptions o = options("diverged");
  o.config.train.steps = 200;
  o.config.train.learning_rate = 1;
  o.config.train.final_learning_rate = 1;
  o.config.train.warmup = 0;
  o.config.train.grad_clip = 0;
  o.config.train.weight_decay =
      10;  // each step turns the weights over and makes them 9 times larger
  o.config.train.save_every = 1;
  o.config.train.validate_every = 1000;
  const std::string message = refusal<DataError>([&] { train(o); });
  EXPECT_TRUE(contains(message, "is not finite")) << message;
  EXPECT_TRUE(contains(message, "diverged")) << message;
  const StoredModel last = load_model(o.out / "last");
  EXPECT_GE(load_json(o.out / "last" / "state.json").at("step").get<int>(), 1);
  for (const SelfTestCase& one : last.self_test)
    for (const float logit : one.logits) EXPECT_TRUE(std::isfinite(logit));
}

TEST_F(Training, BalancedClipsWeighTheSame) {
  TrainOptions o = options("run");
  o.config.train.balance = "style";
  o.config.train.balance_share = 1;
  const Corpus corpus = set_up_training(o).train;
  ASSERT_EQ(corpus.clips.size(), 2u);
  const auto weight = [&](std::size_t clip) {
    return corpus.clips[clip].weight * static_cast<double>(corpus.clips[clip].ids.size());
  };
  EXPECT_NE(corpus.clips[0].ids.size(), corpus.clips[1].ids.size());
  EXPECT_NEAR(weight(0), weight(1), 1e-12);
}

TEST_F(Training, FoldersThatAreTakenAreRefused) {
  TrainOptions o = options("run");
  o.config.train.steps = 1;
  train(o);
  const std::string log = read_file(o.out / "log.jsonl");
  EXPECT_TRUE(contains(refusal<UsageError>([&] { train(o); }), "--resume"));
  EXPECT_EQ(read_file(o.out / "log.jsonl"), log);
  o.out = runs_ / "photos";
  fs::create_directories(o.out);
  put((o.out / "dance.jpg").string(), "precious");
  refusal<UsageError>([&] { train(o); });
  EXPECT_EQ(read_file(o.out / "dance.jpg"), "precious");
  o.out = runs_ / "photos" / "dance.jpg";
  refusal<DataError>([&] { train(o); });
  o.out = runs_ / "absent";
  o.resume = true;
  EXPECT_TRUE(contains(refusal<UsageError>([&] { train(o); }), "no checkpoint"));
  EXPECT_FALSE(fs::exists(o.out));
}

TEST_F(Training, WhatDoesNotFitIsRefusedBeforeAnythingIsWritten) {
  TrainOptions o = options("run");
  o.config.train.conditions = {"stile"};
  EXPECT_TRUE(contains(refusal<UsageError>([&] { train(o); }), "did you mean \"style\""));
  o = options("run");
  o.config.train.balance = "styl";
  EXPECT_TRUE(contains(refusal<UsageError>([&] { train(o); }), "did you mean \"style\""));
  o = options("run");
  o.config.model.n_head = 3;
  refusal<UsageError>([&] { train(o); });
  o = options("run");
  o.config.model.block_size = 16;
  EXPECT_NO_THROW(set_up_training(o));
  o.config.tokenizer.joints = {"thesis"};
  refusal<UsageError>([&] { train(o); });
  o = options("run");
  o.data = runs_ / "absent";
  refusal<DataError>([&] { train(o); });
  o.data = write_dataset(runs_ / "one-sided", {{"a", "train", 30}}).directory;
  EXPECT_TRUE(contains(refusal<DataError>([&] { train(o); }), "\"validation\""));
  o = options("run");
  o.from = runs_ / "absent";
  refusal<DataError>([&] { train(o); });
  EXPECT_FALSE(fs::exists(o.out));
}

TEST_F(Training, DamagedCheckpointsAreRefused) {
  TrainOptions o = options("run");
  o.stop_after_step = 2;
  train(o);
  o.resume = true;
  for (const std::string name : {"optimizer.safetensors", "state.json", "model.safetensors"}) {
    const fs::path file = o.out / "last" / name;
    const std::string bytes = read_file(file);
    put(file.string(), bytes.substr(0, bytes.size() - 9));
    EXPECT_TRUE(contains(refusal<DataError>([&] { train(o); }), name));
    put(file.string(), bytes);
  }
  fs::rename(o.out / "settings.json", o.out / "other.json");
  EXPECT_TRUE(contains(refusal<DataError>([&] { train(o); }), "settings.json"));
}

TEST_F(Training, TheLearningRateWarmsUpAndDecays) {
  TrainConfig c;
  c.learning_rate = 2;
  c.final_learning_rate = 0.1;
  c.warmup = 4;
  EXPECT_DOUBLE_EQ(scheduled_rate(c, 0, 0), 0.5);
  EXPECT_DOUBLE_EQ(scheduled_rate(c, 3, 0.1), 2);
  EXPECT_DOUBLE_EQ(scheduled_rate(c, 4, 0.5), 0.2 + 0.9);
  EXPECT_NEAR(scheduled_rate(c, 100, 1), 0.2, 1e-12);
  EXPECT_NEAR(scheduled_rate(c, 100, 1.5), 0.2, 1e-12);
  c.final_learning_rate = 1;
  EXPECT_DOUBLE_EQ(scheduled_rate(c, 50, 0.7), 2);
}

TEST_F(Training, Bf16AndF32LearnAlike) {
  if (choose_precision("auto", at::kCPU) != at::kBFloat16)
    GTEST_SKIP() << "this processor does not multiply bf16";
  std::map<std::string, std::vector<Json>> curves;
  for (const char* precision : {"f32", "bf16"}) {
    TrainOptions o = options(precision);
    o.config.train.precision = precision;
    o.config.model.dropout = 0;
    o.config.train.steps = 200;
    o.config.train.validate_every = 25;
    o.config.train.save_every = 200;
    train(o);
    curves[precision] = log_lines(o.out);
  }
  ASSERT_EQ(curves["f32"].size(), 8u);
  double worst = 0;
  for (std::size_t i = 0; i < 8; ++i)
    worst = std::max(worst, std::abs(curves["f32"][i].at("loss").get<double>() -
                                     curves["bf16"][i].at("loss").get<double>()));
  std::printf("largest difference of the loss curves: %.4f nats, last loss %.4f\n", worst,
              curves["f32"].back().at("loss").get<double>());
  EXPECT_LT(worst, 0.03);
  EXPECT_GT(worst, 0);  // two computations, not one
}

}  // namespace

}  // namespace mocaplm::trainer_test
