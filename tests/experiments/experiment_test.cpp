// The files of experiments: what they say, and what they must not.
#include "experiments/experiment.h"

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"

namespace mocaplm::experiment_test {
namespace {

class ExperimentFile : public testing::Test {
 protected:
  Experiment read(const std::string& text, double minutes = 0,
                  const std::vector<std::string>& set = {}) const {
    write_file(folder_ / "table.json", text);
    return load_experiment(folder_ / "table.json", minutes, set);
  }
  std::string refused(const std::string& text) const {
    return refusal<DataError>([&] { read(text); });
  }
  TemporaryFolder folder_;
};

constexpr const char* kTwoRows = R"({
  "title": "two",
  "config": {"tokenizer": {"joints": ["left_arm"]}, "model": {"n_layer": 3, "reach": 7},
             "train": {"steps": 9}},
  "rows": [{"name": "a", "data": "other"},
           {"name": "b", "row": "B", "column": "C", "from": "a",
            "change": {"tokenizer": {"joints": ["legs", "root"]}, "model": {"n_layer": 1}}}]})";

TEST_F(ExperimentFile, RowsChangeWhatAllHave) {
  const Experiment e = read(kTwoRows);
  EXPECT_EQ(e.title, "two");
  EXPECT_FALSE(e.classify);
  EXPECT_TRUE(e.needs_other_data());
  ASSERT_EQ(e.rows.size(), 2u);
  EXPECT_EQ(e.rows[0].line, "a");
  EXPECT_EQ(e.rows[0].column, "");
  EXPECT_TRUE(e.rows[0].other_data);
  EXPECT_EQ(e.rows[0].config.model.n_layer, 3);
  EXPECT_EQ(e.rows[0].config.tokenizer.joints, std::vector<std::string>{"left_arm"});
  EXPECT_EQ(e.rows[1].line, "B");
  EXPECT_EQ(e.rows[1].column, "C");
  EXPECT_EQ(e.rows[1].from, "a");
  EXPECT_FALSE(e.rows[1].other_data);
  EXPECT_EQ(e.rows[1].config.model.n_layer, 1);
  EXPECT_EQ(e.rows[1].config.model.reach, 7);
  EXPECT_EQ(e.rows[1].config.train.steps, 9);
  EXPECT_EQ(e.rows[1].config.tokenizer.joints, (std::vector<std::string>{"legs", "root"}));
}

TEST_F(ExperimentFile, TheCommandLineWinsInEveryRow) {
  const Experiment e = read(kTwoRows, 0.5,
                            {"model.n_layer=2", "tokenizer.joints=spine,root", "train.mirror=true",
                             "model.position=absolute", "train.learning_rate=1e-4"});
  for (const ExperimentRow& row : e.rows) {
    EXPECT_EQ(row.config.model.n_layer, 2);
    EXPECT_EQ(row.config.model.reach, 7);
    EXPECT_EQ(row.config.model.position, "absolute");
    EXPECT_EQ(row.config.tokenizer.joints, (std::vector<std::string>{"spine", "root"}));
    EXPECT_TRUE(row.config.train.mirror);
    EXPECT_EQ(row.config.train.learning_rate, 1e-4);
    EXPECT_EQ(row.config.train.max_minutes, 0.5);
  }
}

TEST_F(ExperimentFile, SettingsThatAreNoneAreRefused) {
  const auto refused = [&](const std::string& set) {
    return refusal<UsageError>([&] { read(kTwoRows, 0, {set}); });
  };
  EXPECT_TRUE(contains(refused("model.n_layers=2"), "did you mean \"n_layer\""));
  EXPECT_TRUE(contains(refused("modl.n_layer=2"), "\"model\""));
  EXPECT_TRUE(contains(refused("n_layer=2"), "section.key=value"));
  EXPECT_TRUE(contains(refused("model.n_layer=two"), "n_layer"));
  EXPECT_TRUE(contains(refused("model.n_layer=0"), "n_layer"));
  EXPECT_TRUE(contains(refused("model.position=somewhere"), "position"));
  EXPECT_TRUE(contains(refused("classify.steps=2"), "classify"));
}

TEST_F(ExperimentFile, WhatIsNotSuchATableIsRefused) {
  EXPECT_TRUE(contains(refused(R"({"rows": [{"name": "a"}]})"), "title"));
  EXPECT_TRUE(contains(refused(R"({"title": "t", "rows": []})"), "rows"));
  EXPECT_TRUE(
      contains(refused(R"({"title": "t", "rows": [{"name": "a"}, {"name": "a"}]})"), "two rows"));
  EXPECT_TRUE(
      contains(refused(R"({"title": "t", "rows": [{"name": "a", "from": "b"}, {"name": "b"}]})"),
               "no earlier row"));
  EXPECT_TRUE(contains(refused(R"({"title": "t", "rows": [{"name": "a", "frm": "b"}]})"), "frm"));
  EXPECT_TRUE(contains(
      refused(R"({"title": "t", "rows": [{"name": "a", "change": {"model": {"layers": 1}}}]})"),
      "layers"));
  EXPECT_TRUE(contains(
      refused(R"({"title": "t", "config": {"modell": {}}, "rows": [{"name": "a"}]})"), "modell"));
  EXPECT_TRUE(contains(
      refused(R"({"title": "t", "classify": {"stps": 1}, "rows": [{"name": "a"}]})"), "stps"));
}

TEST_F(ExperimentFile, ClassificationHasItsOwnSettings) {
  const Experiment e =
      read(R"({"title": "t", "classify": {"steps": 5, "labels": ["x"]}, "rows": [{"name": "a"}]})",
           2, {"classify.batch_size=3"});
  ASSERT_TRUE(e.classify);
  EXPECT_EQ(e.classify->steps, 5);
  EXPECT_EQ(e.classify->batch_size, 3);
  EXPECT_EQ(e.classify->max_minutes, 2);
  EXPECT_EQ(e.classify->labels, std::vector<std::string>{"x"});
}

TEST_F(ExperimentFile, TheThesissTablesAreThere) {
  const std::string configs = MOCAPLM_SOURCE_DIR "/configs/";
  const auto rows = [&](const std::string& file) {
    return load_experiment(configs + file).rows.size();
  };
  EXPECT_EQ(rows("thesis/table-4-4.json"), 4u);
  EXPECT_EQ(rows("thesis/table-4-5.json"), 4u);
  EXPECT_EQ(rows("thesis/table-4-6.json"), 4u);
  EXPECT_EQ(rows("thesis/table-4-8.json"), 1u);
  const Experiment both = load_experiment(configs + "experiments/frames-against-flat.json");
  ASSERT_EQ(both.rows.size(), 2u);
  const RunConfig &flat = both.rows[0].config, &frames = both.rows[1].config;
  EXPECT_EQ(flat.model.architecture, "flat");
  EXPECT_EQ(frames.model.architecture, "frames");
  EXPECT_EQ(flat.model.output, frames.model.output);
  EXPECT_EQ(flat.train.max_minutes, frames.train.max_minutes);
  EXPECT_EQ(settings_json(flat.tokenizer), settings_json(frames.tokenizer));
}

}  // namespace
}  // namespace mocaplm::experiment_test
