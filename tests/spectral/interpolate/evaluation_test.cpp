#include "spectral/interpolate/evaluation.h"

#include <gtest/gtest.h>

#include <set>

#include "common/error.h"
#include "common/temporary_folder.h"
#include "spectral/interpolate/interpolate.h"
#include "spectral/measures.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::evaluation_test {
namespace {

// Six clips of each of two genres, two that are too short and one without the label.
Dataset made(const std::filesystem::path& folder) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 12; ++i)
    clips.push_back({"c" + std::to_string(10 + i),
                     i < 4 ? "test" : "train",
                     44 + i,
                     {{"genre", i % 2 == 0 ? "x" : "y"}}});
  clips.push_back({"one", "train", 1, {{"genre", "z"}}});
  clips.push_back({"short", "train", 30, {{"genre", "z"}}});
  clips.push_back({"unlabelled", "train", 60});
  return write_dataset(folder, clips);
}

InterpolatePairs pairs_of(std::int64_t count, std::int64_t seed = 1) {
  InterpolatePairs config;
  config.pairs = count;
  config.seed = seed;
  return config;
}

double number(const Table& table, std::size_t row, std::size_t column) {
  return table.rows().at(row).at(column).get<double>();
}

TEST(InterpolatePairs, DifferInTheLabelAndShareNoClip) {
  const TemporaryFolder folder;
  const Dataset dataset = made(folder / "data");
  for (const std::int64_t seed : {1, 2, 3}) {
    const auto pairs = different_pairs(dataset, "genre", pairs_of(6, seed));
    ASSERT_EQ(pairs.size(), 6u);
    std::set<std::size_t> seen;
    for (const auto& [a, b] : pairs) {
      EXPECT_NE(dataset.entries[a].labels.at("genre"), dataset.entries[b].labels.at("genre"));
      for (const std::size_t one : {a, b}) {
        EXPECT_GE(dataset.entries[one].seconds(), 2);
        EXPECT_TRUE(seen.insert(one).second);
      }
    }
    EXPECT_EQ(pairs, different_pairs(dataset, "genre", pairs_of(6, seed)));
  }
  EXPECT_NE(different_pairs(dataset, "genre", pairs_of(6, 1)),
            different_pairs(dataset, "genre", pairs_of(6, 2)));
  EXPECT_EQ(different_pairs(dataset, "genre", pairs_of(50)).size(), 6u);
  InterpolatePairs test = pairs_of(50);
  test.split = "test";
  for (const auto& [a, b] : different_pairs(dataset, "genre", test)) {
    EXPECT_EQ(dataset.entries[a].split, "test");
    EXPECT_EQ(dataset.entries[b].split, "test");
  }
}

TEST(InterpolateEvaluation, TablesHoldWhatInterpolateGives) {
  const TemporaryFolder folder;
  const Dataset dataset = made(folder / "data");
  InterpolateEvaluation options;
  options.dataset = folder / "data";
  options.label = "genre";
  options.pairs = pairs_of(2);
  options.config.fps = 20;
  options.config.steps = 100;
  options.config.stft_window = 8;
  options.config.coefficients = 6;
  const std::vector<Table> tables = evaluate_interpolate(options);
  ASSERT_EQ(tables.size(), 3u);
  ASSERT_EQ(tables[0].rows().size(), 6u);
  ASSERT_EQ(tables[1].rows().size(), 2u);
  ASSERT_EQ(tables[2].rows().size(), 2u);

  // The first kind, dct within the range, by hand.
  options.config.target = "dct";
  double left = 0, similar = 0;
  const auto pairs = different_pairs(dataset, "genre", options.pairs);
  for (std::size_t p = 0; p < 2; ++p) {
    const InterpolateResult result =
        interpolate(load_clip(dataset, dataset.entries[pairs[p].first]),
                    load_clip(dataset, dataset.entries[pairs[p].second]), options.config);
    left += 50 * result.error_after / result.error_before;
    similar += 0.5 * result.stft.result_target;
    EXPECT_EQ(tables[1].rows()[p][0], result.original.name);
    EXPECT_NEAR(number(tables[1], p, 2), result.stft.original_target, 1e-12);
    EXPECT_NEAR(number(tables[1], p, 4), result.stft.result_target, 1e-12);
    EXPECT_NEAR(number(tables[2], p, 4), roughness(result.result), 1e-9 * roughness(result.result));
  }
  EXPECT_NEAR(number(tables[0], 0, 2), left, 1e-9);
  EXPECT_NEAR(number(tables[0], 0, 5), similar, 1e-12);
  // The descent ends at the weighted mean: a quarter of the squared error is left.
  for (const std::size_t linear : {0, 1, 4}) EXPECT_NEAR(number(tables[0], linear, 2), 25, 0.1);
  EXPECT_EQ(tables[0].rows()[5][0], "own_pca");
}

TEST(InterpolateEvaluation, RefusesWhatCannotBe) {
  const TemporaryFolder folder;
  const Dataset dataset = made(folder / "data");
  EXPECT_TRUE(contains(refusal<UsageError>([&] { different_pairs(dataset, "gnre", pairs_of(1)); }),
                       "genre"));
  const Dataset alike = write_dataset(folder / "alike", {{"a", "train", 60, {{"genre", "x"}}},
                                                         {"b", "train", 60, {{"genre", "x"}}}});
  EXPECT_TRUE(
      contains(refusal([&] { different_pairs(alike, "genre", pairs_of(1)); }), "no two clips"));
  const Dataset lone = write_dataset(
      folder / "lone", {{"a", "train", 60, {{"genre", "x"}}}, {"b", "train", 1, {{"genre", "y"}}}});
  EXPECT_TRUE(
      contains(refusal([&] { different_pairs(lone, "genre", pairs_of(1)); }), "clips of 2 s"));
}

}  // namespace
}  // namespace mocaplm::evaluation_test
