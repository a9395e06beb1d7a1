#include "spectral/query.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/temporary_folder.h"
#include "motion/formats/npz.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::query_test {
namespace {

QueryOptions asked(const TemporaryFolder& folder, const std::string& clip) {
  QueryOptions options;
  options.dataset = folder / "data";
  options.clip = clip;
  options.config.fps = 20;
  options.config.window = 24;
  options.config.stride = 4;
  options.threads = 1;
  return options;
}

// "b" is "a" again; "c" and "d" are other motions.
Dataset made(const TemporaryFolder& folder) {
  return write_dataset(folder / "data", {{"a", "train", 60, {{"genre", "x"}}, 20, 7},
                                         {"b", "train", 60, {{"genre", "x"}}, 20, 7},
                                         {"c", "train", 60, {{"genre", "y"}}},
                                         {"d", "test", 60, {{"genre", "y"}}},
                                         {"short", "test", 1}});
}

TEST(Query, FindsTheSameMotionAtItsPlace) {
  const TemporaryFolder folder;
  made(folder);
  for (const char* metric : {"cosine", "euclidean"}) {
    QueryOptions options = asked(folder, "a:0.8-2.0");
    options.query.metric = metric;
    const QueryResult result = run_query(options);
    ASSERT_EQ(result.matches.size(), 3u);  // one of each other clip
    EXPECT_EQ(result.matches[0].clip, "b");
    EXPECT_NEAR(result.matches[0].from, 0.8, 1e-9);
    EXPECT_NEAR(result.matches[0].to, 2.0, 1e-9);
    EXPECT_NEAR(result.matches[0].neighbour.similarity, 1, 1e-6);
    EXPECT_NEAR(result.matches[0].neighbour.distance, 0, 1e-3);
    EXPECT_EQ(match_clip(result, result.matches[0]).poses, result.query.poses);
    const Table table = query_table(result, options);
    EXPECT_EQ(table.rows()[0][0], "b");
    EXPECT_EQ(table.rows()[0][6], "x");
  }
}

TEST(Query, PerClipAndExclusion) {
  const TemporaryFolder folder;
  made(folder);
  QueryOptions options = asked(folder, "a");
  options.query.exclude_same = "none";
  EXPECT_EQ(run_query(options).matches[0].clip, "a");
  EXPECT_EQ(run_query(options).windows, 10);
  options.query.per_clip = 100;
  options.query.k = 1000;
  EXPECT_EQ(run_query(options).matches.size(), 40u);
  options.clip = (folder / "data/clips/a.npz").string();  // a file is no clip of the dataset
  options.query.exclude_same = "clip";
  EXPECT_EQ(run_query(options).matches.size(), 40u);
}

TEST(Query, ShortPiecesAreAnswered) {
  const TemporaryFolder folder;
  made(folder);
  EXPECT_TRUE(contains(refusal([&] { run_query(asked(folder, "a:0-0.5")); }), "--short-clips"));
  EXPECT_TRUE(contains(refusal([&] { run_query(asked(folder, "short")); }), "shorter than"));
  QueryOptions options = asked(folder, "short");
  options.config.short_clips = "hold";
  EXPECT_FALSE(run_query(options).matches.empty());
  write_dataset(folder / "data", {{"a", "train", 60}});
  EXPECT_TRUE(contains(refusal([&] { run_query(asked(folder, "a")); }), "no windows are left"));
}

}  // namespace
}  // namespace mocaplm::query_test
