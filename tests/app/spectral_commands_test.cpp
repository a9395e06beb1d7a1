// query, filter and interpolate as they are called: files, tables, exit codes.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "motion/formats/npz.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "temporary_folder.h"

namespace fs = std::filesystem;

namespace mocaplm {
namespace {

class SpectralCommands : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    write_dataset(*folder_ / "data", {{"a", "train", 80, {{"genre", "x"}}, 20, 7},
                                      {"b", "test", 80, {{"genre", "x"}}, 20, 7},
                                      {"c", "train", 80, {{"genre", "y"}}},
                                      {"one", "test", 1}});
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string at(const std::string& name) { return (*folder_ / name).string(); }
  static std::string clip(const std::string& name) { return at("data/clips/" + name + ".npz"); }
  static std::string query() { return "query --index " + at("data") + " --fps 20 --window 32 "; }

  static void refused(const std::string& arguments, int code, const std::string& part) {
    const Ran ran = run_mocaplm(arguments);
    EXPECT_EQ(ran.code, code) << ran.text;
    EXPECT_TRUE(contains(ran.text, part)) << ran.text;
  }

  static TemporaryFolder* folder_;
};

TemporaryFolder* SpectralCommands::folder_ = nullptr;

TEST_F(SpectralCommands, QueryPrintsAndShowsMatches) {
  const Ran ran =
      run_mocaplm(query() + "a:0.5-2.1 -k 2 --page " + at("q.html") + " --json " + at("q.json"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_TRUE(contains(ran.text, "cosine similarity")) << ran.text;
  const Json table = load_json(at("q.json"));
  ASSERT_EQ(table["rows"].size(), 2u);
  EXPECT_EQ(table["rows"][0]["clip"], "b");
  // The query begins between the windows of the index: alike, not the same.
  EXPECT_GT(table["rows"][0]["cosine similarity"].get<double>(), 0.9);
  EXPECT_LT(table["rows"][1]["cosine similarity"].get<double>(),
            table["rows"][0]["cosine similarity"].get<double>());
  EXPECT_TRUE(contains(read_file(at("q.html")), "like a:0.5-2.1"));
  EXPECT_TRUE(contains(run_mocaplm(query() + "a").text, "kept from before"));
}

TEST_F(SpectralCommands, QueryEvaluatesLabels) {
  const Ran ran = run_mocaplm(query() + "--evaluate genre --split all -k 1 --feature dct --json " +
                              at("e.json"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  const Json rows = load_json(at("e.json"))["rows"];
  ASSERT_EQ(rows.size(), 3u);  // two metrics, chance
  EXPECT_EQ(rows[2]["feature"], "chance");
}

TEST_F(SpectralCommands, QueryRefusesWhatCannotBe) {
  refused(query(), 2, "--evaluate");
  refused(query() + "a --evaluate genre", 2, "no CLIP");
  refused(query() + "--evaluate gnre", 2, "genre");
  refused(query() + "a --page x.npz", 2, "x.npz");
  refused(query() + "a:9-12", 2, "begins at 9");
  refused(query() + "nobody", 3, "nobody");
  refused(query() + "one", 3, "shorter than a window");
  refused("query --index " + at("none") + " a", 3, "none");
  refused(query() + "a --stft-window 64", 2, "stft_window");
  fs::create_directories(at("kept"));
  ASSERT_EQ(run_mocaplm(query() + "a --keep " + at("kept")).code, 0);
  write_dataset(*folder_ / "other", {{"a", "train", 80}});
  refused("query --index " + at("other") + " --fps 20 --window 32 a --keep " + at("kept"), 3,
          "another dataset");
}

TEST_F(SpectralCommands, FilterWritesTheMotion) {
  const Ran ran = run_mocaplm("filter " + clip("a") + ":0-3 --to-hz 2 --out " + at("low") +
                              " --plot " + at("p.svg") + " --spectrogram " + at("s.svg"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_EQ(read_npz(at("low.npz")).frames(), 60);
  for (const char* name : {"low.bvh", "low.html", "p.svg", "s.svg"})
    EXPECT_GT(fs::file_size(at(name)), 100u) << name;
  refused("filter " + clip("one") + " --out " + at("x.npz"), 3, "one frame");
  refused("filter " + clip("a") + " --from-hz 2 --out " + at("x.npz"), 2, "--keep band");
  refused("filter " + clip("a") + " --keep band --from-hz 3 --to-hz 2 --out " + at("x.npz"), 2,
          "from_hz");
  refused("filter " + clip("a") + " --out " + clip("a"), 2, "replace");
  EXPECT_FALSE(fs::exists(at("x.npz")));
}

TEST_F(SpectralCommands, InterpolateWritesTheMotion) {
  if (!fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch"))
    GTEST_SKIP() << "mocaplm-torch is not built here";
  const Ran ran =
      run_mocaplm("interpolate " + clip("a") + " " + clip("c") + " --fps 20 --steps 5 --out " +
                  at("mid") + " --spectrogram " + at("i.svg") + " --json " + at("i.json"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_EQ(read_npz(at("mid.npz")).frames(), 80);
  EXPECT_EQ(load_json(at("i.json"))["rows"].size(), 3u);
  EXPECT_GT(fs::file_size(at("i.svg")), 100u);
  refused("interpolate " + clip("a") + " " + clip("one") + " --out " + at("x.npz"), 3, "one frame");
  refused("interpolate " + clip("a") + " " + clip("c") + " --from-hz 5 --out " + at("x.npz"), 2,
          "from_hz");
}

}  // namespace
}  // namespace mocaplm
