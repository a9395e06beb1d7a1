#include "spectral/evaluation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/error.h"
#include "common/temporary_folder.h"
#include "common/text.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::evaluation_test {
namespace {

SpectralConfig small_config() {
  SpectralConfig config;
  config.fps = 20;
  config.window = 24;
  config.stride = 24;
  config.coefficients = 6;
  return config;
}

// Clips made of few motions: those of one seed are the same motion, and so have the same genre.
Dataset made(const std::filesystem::path& folder) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 12; ++i) {
    const std::string name = "c" + std::to_string(10 + i);
    clips.push_back({name,
                     i < 3 ? "test" : "train",
                     24,
                     {{"genre", std::string(1, char('a' + i % 3))}},
                     20,
                     std::uint64_t(50 + i % 3)});
  }
  clips.push_back({"unlabelled", "train", 24, {}, 20, 50});
  return write_dataset(folder, clips);
}

QueryEvaluation asked(const std::filesystem::path& folder) {
  QueryEvaluation options;
  options.dataset = folder;
  options.config = small_config();
  options.labels = {"genre"};
  options.query.k = 3;
  options.threads = 1;
  return options;
}

double cell(const Table& table, std::size_t row, std::size_t column) {
  return table.rows().at(row).at(column).get<double>();
}

TEST(QueryEvaluation, EntropyIsInBans) {
  EXPECT_EQ(entropy_in_bans({}), 0);
  EXPECT_EQ(entropy_in_bans({"a", "a"}), 0);
  EXPECT_NEAR(entropy_in_bans({"a", "b", "c", "d", "e", "f", "g", "h", "i", "j"}), 1, 1e-12);
  EXPECT_NEAR(entropy_in_bans({"a", "b", "a", "a"}),
              -(0.75 * std::log10(0.75) + 0.25 * std::log10(0.25)), 1e-12);
}

TEST(QueryEvaluation, VoteGoesToTheNearestOfEqualOnes) {
  EXPECT_EQ(vote({"b", "a", "a"}), "a");
  EXPECT_EQ(vote({"b", "a", "a", "b"}), "b");
  EXPECT_EQ(vote({"z"}), "z");
}

TEST(QueryEvaluation, FindsTheSameMotions) {
  const TemporaryFolder folder;
  made(folder / "data");
  const Table table = evaluate_query(asked(folder / "data"));
  ASSERT_EQ(table.rows().size(), 7u);  // three features, two metrics, chance
  for (std::size_t row = 0; row < 6; ++row) {
    EXPECT_EQ(cell(table, row, 3), 100);
    EXPECT_EQ(cell(table, row, 4), 0);
    EXPECT_EQ(cell(table, row, 5), 100);
  }
  EXPECT_NEAR(cell(table, 6, 3), 100.0 / 3, 1e-9);
  EXPECT_NEAR(cell(table, 6, 4), std::log10(3.0), 1e-9);
  EXPECT_NEAR(cell(table, 6, 5), 100.0 / 3, 1e-9);
}

// With the groups of the same motion left out, only wrong neighbours are left.
TEST(QueryEvaluation, ExclusionLeavesOutWhatItSays) {
  const TemporaryFolder folder;
  Dataset dataset = made(folder / "data");
  for (DatasetEntry& entry : dataset.entries)
    if (entry.labels.count("genre") > 0) entry.group = entry.labels["genre"];
  save_dataset(dataset);
  QueryEvaluation options = asked(folder / "data");
  options.features = {"dct"};
  options.metrics = {"cosine"};
  options.query.exclude_same = "group";
  EXPECT_EQ(cell(evaluate_query(options), 0, 5), 0);
  options.query.exclude_same = "clip";
  EXPECT_EQ(cell(evaluate_query(options), 0, 5), 100);
  options.query.k = 12;  // all others: 3 of 11 have the query's genre
  EXPECT_NEAR(cell(evaluate_query(options), 0, 5), 300.0 / 11, 1e-9);
  options.query.exclude_same = "none";  // its own window is never found
  EXPECT_NEAR(cell(evaluate_query(options), 0, 5), 300.0 / 11, 1e-9);
  options.against = "test";
  EXPECT_EQ(cell(evaluate_query(options), 0, 5), 0);
}

// A genre that one clip alone has: told, not hidden in the share that is right.
TEST(QueryEvaluation, CountsQueriesThatCannotBeRight) {
  const TemporaryFolder folder;
  write_dataset(folder / "data", {{"a", "test", 24, {{"genre", "x"}}, 20, 7},
                                  {"b", "train", 24, {{"genre", "x"}}, 20, 7},
                                  {"c", "test", 48, {{"genre", "y"}}},
                                  {"d", "train", 24, {{"genre", "z"}}}});
  QueryEvaluation options = asked(folder / "data");
  options.query.k = 1;
  const auto notes = [&] { return join(evaluate_query(options).notes(), "\n"); };
  EXPECT_TRUE(contains(notes(), "2 of these windows have a genre that nothing")) << notes();
  EXPECT_NEAR(cell(evaluate_query(options), 0, 3), 100.0 / 3, 1e-9);
  options.query.exclude_same = "none";  // the clip's other window has its genre
  EXPECT_FALSE(contains(notes(), "that nothing")) << notes();
}

TEST(QueryEvaluation, RefusesWhatCannotBe) {
  const TemporaryFolder folder;
  made(folder / "data");
  const auto usage = [&](const auto& change) {
    QueryEvaluation options = asked(folder / "data");
    change(options);
    return refusal<UsageError>([&] { evaluate_query(options); });
  };
  EXPECT_TRUE(contains(usage([](auto& o) { o.labels = {"gnre"}; }), "genre"));
  EXPECT_TRUE(contains(usage([](auto& o) { o.labels = {}; }), "label"));
  EXPECT_TRUE(contains(usage([](auto& o) { o.features = {"dst"}; }), "dct"));
  EXPECT_TRUE(contains(usage([](auto& o) { o.metrics = {"l1"}; }), "euclidean"));
  EXPECT_TRUE(contains(usage([](auto& o) { o.split = "tset"; }), "train"));
  QueryEvaluation options = asked(folder / "data");
  options.split = "validation";
  EXPECT_TRUE(contains(refusal([&] { evaluate_query(options); }), "empty"));
  options = asked(folder / "data");
  options.config.window = 25;
  options.against = "test";
  EXPECT_TRUE(contains(refusal([&] { evaluate_query(options); }), "as long as a window"));
  options = asked(folder / "data");
  options.query.exclude_same = "clip";
  write_dataset(folder / "alone", {{"a", "test", 24, {{"genre", "x"}}}});
  options.dataset = folder / "alone";
  EXPECT_TRUE(contains(refusal([&] { evaluate_query(options); }), "nothing is left"));
}

}  // namespace
}  // namespace mocaplm::evaluation_test
