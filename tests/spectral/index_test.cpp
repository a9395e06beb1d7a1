#include "spectral/index.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::index_test {
namespace {

SpectralConfig small_config(const std::string& feature = "dct") {
  SpectralConfig config;
  config.feature = feature;
  config.fps = 20;
  config.window = 24;
  config.stride = 8;
  config.coefficients = 6;
  return config;
}

std::vector<SmallClip> clips() {
  return {{"a", "train", 60, {{"genre", "x"}}},
          {"b", "train", 24},
          {"c", "test", 23},
          {"d", "test", 1},
          {"e", "test", 50}};
}

TEST(Index, HoldsTheFeaturesOfAllWindows) {
  const TemporaryFolder folder;
  const Dataset dataset = write_dataset(folder / "data", clips());
  for (const char* feature : {"stft", "dct", "pca", "pose"})
    for (const std::int64_t reduce : {0, 5}) {
      SpectralConfig config = small_config(feature);
      config.reduce = reduce;
      build_index(dataset, config, folder / "x.index", 2);
      const SpectralIndex index(folder / "x.index");
      EXPECT_EQ(index.clips(), (std::vector<std::string>{"a", "b", "c", "d", "e"}));
      EXPECT_EQ(index.clips_too_short(), 2);
      EXPECT_EQ(index.fingerprint(), dataset_fingerprint(dataset));
      ASSERT_EQ(index.size(), 6 + 1 + 5);
      for (Eigen::Index row = 0; row < index.size(); ++row) {
        const MotionWindow window = index.window(row);
        const Clip clip = at_window_rate(load_clip(dataset, dataset.entries[window.clip]), config);
        const Series made = index.features().rows(
            {window_series(clip, window.first, config.window, config_joints(config))});
        EXPECT_LT((index.rows().row(row) * index.lengths()[row] - made.row(0)).norm(),
                  1e-4f * made.norm())
            << feature << " " << reduce << " " << row;
        EXPECT_NEAR(index.rows().row(row).norm(), 1, 1e-5);
      }
    }
}

TEST(Index, IsKeptAndBuiltAgainWhenTheDatasetChanges) {
  const TemporaryFolder folder;
  std::vector<SmallClip> some = clips();
  Dataset dataset = write_dataset(folder / "data", some);
  std::string note;
  EXPECT_EQ(index_of(dataset, small_config(), "", 1, &note).size(), 12);
  EXPECT_TRUE(contains(note, "built now")) << note;
  index_of(dataset, small_config(), "", 1, &note);
  EXPECT_TRUE(contains(note, "kept from before")) << note;
  SpectralConfig other = small_config();
  other.stride = 100;
  EXPECT_EQ(index_of(dataset, other, "", 1, &note).size(), 5);
  EXPECT_TRUE(contains(note, "built now")) << note;

  some[0].frames = 24;
  dataset = write_dataset(folder / "data", some);
  EXPECT_EQ(index_of(dataset, small_config(), "", 1, &note).size(), 7);
  EXPECT_TRUE(contains(note, "built again")) << note;
}

TEST(Index, OfAnotherDatasetIsRefused) {
  const TemporaryFolder folder;
  const Dataset one = write_dataset(folder / "one", clips());
  const Dataset two = write_dataset(folder / "two", {{"a", "train", 40}});
  index_of(one, small_config(), folder / "kept", 1);
  const std::string told = refusal([&] { index_of(two, small_config(), folder / "kept", 1); });
  EXPECT_TRUE(contains(told, "another dataset")) << told;
  EXPECT_TRUE(contains(told, "--keep")) << told;
  EXPECT_EQ(index_of(one, small_config(), folder / "kept", 1).size(), 12);  // still there
}

TEST(Index, DamagedFilesAreRefusedByName) {
  const TemporaryFolder folder;
  const Dataset dataset = write_dataset(folder / "data", clips());
  build_index(dataset, small_config("pca"), folder / "x.index", 1);
  const std::string good = read_file(folder / "x.index");
  const auto told = [&](const std::string& bytes) {
    put((folder / "bad.index").string(), bytes);
    return refusal([&] { SpectralIndex index(folder / "bad.index"); });
  };
  EXPECT_TRUE(contains(told(""), "is empty"));
  EXPECT_TRUE(contains(told("PK"), "is not an index"));
  EXPECT_TRUE(contains(told(std::string(9000, 'x')), "is not an index"));
  EXPECT_TRUE(contains(told(good.substr(0, good.size() - 1)), "cut off"));
  EXPECT_TRUE(contains(told(good.substr(0, 5000)), "cut off"));
  std::string fewer = good;
  const std::size_t at = fewer.find("\"windows\":12");
  ASSERT_NE(at, std::string::npos);
  fewer.replace(at, 12, "\"windows\":11");
  EXPECT_TRUE(contains(told(fewer), "another size"));
  // As many windows as would make the sizes overflow.
  std::string more = good;
  more.replace(more.find("\"windows\":12"), 12, "\"windows\":1099511627776");
  std::uint64_t bytes = 0;  // of the JSON, said at byte 40
  std::memcpy(&bytes, more.data() + 40, sizeof bytes);
  bytes += more.size() - good.size();
  std::memcpy(more.data() + 40, &bytes, sizeof bytes);
  EXPECT_TRUE(contains(told(more), "windows"));
  EXPECT_TRUE(contains(refusal([&] { SpectralIndex index(folder / "none.index"); }), "none.index"));
  EXPECT_TRUE(contains(refusal([&] { SpectralIndex index(folder.path()); }), "not a regular file"));
}

TEST(Index, BadDatasetsAreAnswered) {
  const TemporaryFolder folder;
  const Dataset shorts = write_dataset(folder / "shorts", {{"a", "train", 3}, {"b", "test", 1}});
  const std::string told = refusal([&] { build_index(shorts, small_config(), folder / "x", 1); });
  EXPECT_TRUE(contains(told, "--short-clips hold")) << told;
  EXPECT_FALSE(std::filesystem::exists(folder / "x"));
  SpectralConfig hold = small_config("stft");
  hold.short_clips = "hold";
  build_index(shorts, hold, folder / "x", 1);
  EXPECT_EQ(SpectralIndex(folder / "x").size(), 2);

  const Dataset empty = write_dataset(folder / "empty", {});
  EXPECT_TRUE(contains(refusal([&] { build_index(empty, small_config(), folder / "y", 1); }),
                       "as long as a window"));
  IndexWriter writer(folder / "z", small_config(), {Series::Ones(24, 72)});
  Series bad = Series::Ones(1, writer.features().dimensions());
  bad(0, 3) = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(contains(refusal([&] { writer.add("walk", {0}, bad); }), "walk"));
}

}  // namespace
}  // namespace mocaplm::index_test
