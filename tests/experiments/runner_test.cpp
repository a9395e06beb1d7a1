// Tiny tables from beginning to end: finished rows stay, cut ones go on, others are refused.
#include "experiments/runner.h"

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "evaluate/evaluate.h"
#include "experiments/report.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "train/trainer.h"

namespace fs = std::filesystem;

namespace mocaplm::runner_test {
namespace {

class ExperimentRunner : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_dataset(*folder_ / "own", {{"a", "train", 60, {{"style", "calm"}}},
                                     {"b", "train", 50, {{"style", "wild"}}},
                                     {"c", "validation", 40, {{"style", "calm"}}},
                                     {"d", "test", 45, {{"style", "wild"}}},
                                     {"e", "test", 30, {{"style", "calm"}}}});
    write_dataset(*folder_ / "other",
                  {{"x", "train", 70}, {"e", "train", 30}, {"y", "validation", 40}});
  }
  static void TearDownTestSuite() { folder_.reset(); }

  // 2 joints without the root, 7 tokens a frame.
  Experiment experiment(const std::string& rows, const std::string& more = "") const {
    write_file(file(), R"({"title": "tiny", )" + more + R"(
        "config": {"tokenizer": {"bins": 24, "joints": ["left_knee", "right_elbow"], "root": "none"},
                   "model": {"n_layer": 1, "n_head": 2, "n_embd": 16, "block_size": 96, "dropout": 0},
                   "train": {"steps": 6, "batch_size": 2, "micro_batch": 2, "validate_every": 3,
                             "save_every": 2, "validation_windows": 2, "conditions": ["none"],
                             "precision": "f32"}},
        "rows": [)" + rows +
                           "]}");
    return load_experiment(file());
  }
  ExperimentOptions options(const std::string& out) const {
    ExperimentOptions o;
    o.data = *folder_ / "own";
    o.other_data = *folder_ / "other";
    o.out = out_ / out;
    o.device = "cpu";
    o.threads = 1;
    return o;
  }
  fs::path file() const { return out_ / "table.json"; }

  static std::unique_ptr<TemporaryFolder> folder_;
  TemporaryFolder out_;
};

std::unique_ptr<TemporaryFolder> ExperimentRunner::folder_;

constexpr const char* kThree = R"(
    {"name": "Pre-training", "data": "other"},
    {"name": "Fine-tuning", "from": "Pre-training", "change": {"train": {"steps": 4}}},
    {"name": "Three joints", "change": {"tokenizer": {"joints": ["left_knee", "head", "right_elbow"]}}})";

TEST_F(ExperimentRunner, EqualsTheSingleCommands) {
  const ExperimentOptions o = options("out");
  const std::vector<Table> tables = run_experiment(experiment(kThree), o);
  ASSERT_EQ(tables.size(), 2u);
  ASSERT_EQ(tables[0].rows().size(), 3u);
  EXPECT_TRUE(contains(tables[0].text(), "1 of the clips tested on"));

  // The fine-tuned row by hand.
  TrainOptions train_options;
  train_options.config = experiment(kThree).rows[0].config;
  train_options.data = o.other_data;
  train_options.out = out_ / "first";
  train_options.device = "cpu";
  train_options.threads = 1;
  train(train_options);
  train_options.config = experiment(kThree).rows[1].config;
  train_options.from = train_options.out;
  train_options.data = o.data;
  train_options.out = out_ / "second";
  train(train_options);
  EvaluateOptions evaluate;
  evaluate.model = train_options.out;
  evaluate.data = o.data;
  evaluate.device = "cpu";
  evaluate.threads = 1;
  const SplitBits bits = split_bits(evaluate);
  EXPECT_NEAR(tables[0].rows()[1][1].get<double>(), bits.groups.at("").model.per_frame(0, 6), 1e-6);
  EXPECT_EQ(tables[1].rows()[1][9], 4);  // steps
  EXPECT_EQ(tables[1].rows()[2][4], 9);  // own channels
  const double own = tables[1].rows()[2][3].get<double>(),
               all = tables[1].rows()[2][1].get<double>();
  EXPECT_GT(own, all);  // the third joint is not counted where rows are compared

  // The printed table is evaluate's.
  const Table evaluated = evaluate_tables(evaluate)[0];
  EXPECT_NEAR(evaluated.rows()[0][2].get<double>(), tables[1].rows()[1][3].get<double>(), 1e-6);
  EXPECT_NEAR(evaluated.rows()[0][5].get<double>(), tables[1].rows()[1][2].get<double>(), 1e-9);
  EXPECT_EQ(load_json(o.out / "table.json")["rows"].size(), 3u);
}

TEST_F(ExperimentRunner, GoesOnWhereItWasCutOff) {
  const ExperimentOptions o = options("out"), whole = options("whole");
  const Experiment e = experiment(kThree);
  run_experiment(e, whole);

  // As if killed in the second row after 3 of 4 steps: the first row is finished.
  run_experiment(e, o);
  const auto first = fs::last_write_time(o.out / "pre-training" / "run" / "best");
  fs::remove_all(o.out / "fine-tuning" / "run");
  fs::remove(o.out / "fine-tuning" / "result.json");
  fs::remove_all(o.out / "three-joints");
  TrainOptions cut;
  cut.config = e.rows[1].config;
  cut.from = o.out / "pre-training" / "run";
  cut.data = o.data;
  cut.out = o.out / "fine-tuning" / "run";
  cut.device = "cpu";
  cut.threads = 1;
  cut.stop_after_step = 3;
  train(cut);
  run_experiment(e, o);
  EXPECT_EQ(fs::last_write_time(o.out / "pre-training" / "run" / "best"), first);
  const Json a = load_json(o.out / "table.json"), b = load_json(whole.out / "table.json");
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(a["rows"][i]["bits_of_a_frame"], b["rows"][i]["bits_of_a_frame"]) << i;

  // Cut off before its first checkpoint: begun again.
  fs::remove_all(o.out / "three-joints" / "run" / "last");
  fs::remove(o.out / "three-joints" / "result.json");
  run_experiment(e, o);
  EXPECT_EQ(load_json(o.out / "table.json")["rows"][2]["bits_of_a_frame"],
            b["rows"][2]["bits_of_a_frame"]);
}

TEST_F(ExperimentRunner, RefusesWhatDoesNotFit) {
  ExperimentOptions o = options("out");
  const Experiment one = experiment(R"({"name": "a"})");
  run_experiment(one, o);
  const std::string other = refusal<UsageError>([&] {
    run_experiment(experiment(R"({"name": "a", "change": {"model": {"n_embd": 32}}})"), o);
  });
  EXPECT_TRUE(contains(other, "\"a\"")) << other;
  o.other_data.clear();
  EXPECT_TRUE(contains(refusal<UsageError>([&] { run_experiment(experiment(kThree), o); }),
                       "--other-data"));
  EXPECT_TRUE(contains(refusal<UsageError>([&] {
                         run_experiment(experiment(R"({"name": "A+"}, {"name": "A-"})"),
                                        options("b"));
                       }),
                       "share the folder"));
  fs::create_directories(out_ / "full" / "a");
  write_file(out_ / "full" / "a" / "mine.txt", "kept");
  EXPECT_THROW(run_experiment(one, options("full")), UsageError);
  EXPECT_TRUE(fs::exists(out_ / "full" / "a" / "mine.txt"));
}

TEST_F(ExperimentRunner, Classifies) {
  const ExperimentOptions o = options("classes");
  const Experiment e = experiment(R"({"name": "Our model"})",
                                  R"("classify": {"steps": 3, "batch_size": 2, "labels": ["style"],
                                                  "precision": "f32"},)");
  const std::vector<Table> tables = run_experiment(e, o);
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0].columns(), (std::vector<std::string>{"Method", "style"}));
  ASSERT_EQ(tables[0].rows().size(), 3u);
  EXPECT_EQ(tables[0].rows()[1][0], "LDA");
  EXPECT_TRUE(fs::exists(o.out / "our-model" / "classifier" / "complete"));
  const std::string before = tables[0].text();
  EXPECT_EQ(run_experiment(e, o)[0].text(), before);  // from result.json
}

TEST(RowFolder, IsReadable) {
  EXPECT_EQ(row_folder("13 joints, 20 fps"), "13-joints-20-fps");
  EXPECT_EQ(row_folder("Fine-tuning (lr=2e-4)"), "fine-tuning-lr-2e-4");
  EXPECT_EQ(row_folder("..").substr(0, 4), "row-");
}

}  // namespace
}  // namespace mocaplm::runner_test
