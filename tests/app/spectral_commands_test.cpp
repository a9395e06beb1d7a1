// query, filter and interpolate as they are called: files, tables, exit codes.
#include <gtest/gtest.h>

#include <limits>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "motion/formats/npy.h"
#include "motion/formats/npz.h"
#include "motion/formats/zip_file.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace fs = std::filesystem;

namespace mocaplm::spectral_commands_test {
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

  static bool has_torch() { return fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch"); }

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
  expect_run(query(), 2, "--evaluate");
  expect_run(query() + "a --evaluate genre", 2, "no CLIP");
  expect_run(query() + "--evaluate gnre", 2, "genre");
  expect_run(query() + "a --page x.npz", 2, "x.npz");
  expect_run(query() + "a --split test", 2, "--evaluate");
  expect_run(query() + "--evaluate genre --per-clip 2", 2, "--per-clip");
  expect_run(query() + "a:9-12", 2, "begins at 9");
  expect_run(query() + "nobody", 3, "nobody");
  expect_run(query() + "one", 3, "shorter than a window");
  expect_run("query --index " + at("none") + " a", 3, "none");
  expect_run(query() + "a --stft-window 64", 2, "stft_window");
  fs::create_directories(at("kept"));
  ASSERT_EQ(run_mocaplm(query() + "a --keep " + at("kept")).code, 0);
  write_dataset(*folder_ / "other", {{"a", "train", 80}});
  expect_run("query --index " + at("other") + " --fps 20 --window 32 a --keep " + at("kept"), 3,
             "another dataset");
}

// What motion files may be: not a number somewhere, one frame, joints that never move, a label that
// one clip alone has.
TEST_F(SpectralCommands, BadMotionsAreAnswered) {
  std::vector<double> poses(40 * 72, 0.1);
  poses[5 * 72 + 7] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> trans(40 * 3, 0);
  const double fps = 20;
  write_dataset(*folder_ / "nan",
                {{"a", "train", 40, {{"genre", "x"}}}, {"bad", "test", 40, {{"genre", "x"}}}});
  write_zip(*folder_ / "nan/clips/bad.npz", {{"poses.npy", npy_bytes(poses.data(), {40, 72})},
                                             {"trans.npy", npy_bytes(trans.data(), {40, 3})},
                                             {"mocap_framerate.npy", npy_bytes(&fps, {})}});
  const std::string bad = at("nan/clips/bad.npz");
  expect_run(query() + bad, 3, "frame 5");
  expect_run("query --index " + at("nan") + " --fps 20 --window 32 a", 3, "bad.npz");
  expect_run("query --index " + at("nan") + " --evaluate genre --fps 20 --window 32", 3, "bad.npz");
  expect_run("filter " + bad + " --out " + at("x.npz"), 3, "frame 5");
  if (has_torch())
    expect_run("interpolate " + clip("a") + " " + bad + " --out " + at("x.npz"), 3, "frame 5");

  const Ran lone = run_mocaplm(query() + "--evaluate genre --split all --features dct");
  EXPECT_EQ(lone.code, 0) << lone.text;
  EXPECT_TRUE(contains(lone.text, "have a genre that nothing they may find has")) << lone.text;
  EXPECT_TRUE(contains(lone.text, "1 of 4 clips are shorter")) << lone.text;
}

TEST_F(SpectralCommands, MotionsThatStandStillGiveTables) {
  for (const char* name : {"still", "still2"}) {
    Clip still = random_clip(5, 60, 20);
    still.poses.setZero();
    still.trans.setZero();
    write_npz(at(std::string(name) + ".npz"), still);
  }
  std::vector<std::string> commands = {query() + at("still.npz"),
                                       "filter " + at("still.npz") + " --out " + at("s1.npz")};
  if (has_torch())
    commands.push_back("interpolate " + at("still.npz") + " " + at("still2.npz") + " --out " +
                       at("s2.npz"));
  for (const std::string& command : commands) {
    const Ran ran = run_mocaplm(command);
    EXPECT_EQ(ran.code, 0) << command << ran.text;
    EXPECT_FALSE(contains(ran.text, " nan")) << command << ran.text;
  }
}

TEST_F(SpectralCommands, NothingIsWrittenWhereAPictureCannotBe) {
  expect_run("filter " + clip("a") + ":0-0.5 --out " + at("tiny") + " --spectrogram " + at("t.svg"),
             3, "Hann window");
  for (const char* name : {"tiny.npz", "tiny.html", "t.svg"}) EXPECT_FALSE(fs::exists(at(name)));
}

TEST_F(SpectralCommands, FilterWritesTheMotion) {
  const Ran ran = run_mocaplm("filter " + clip("a") + ":0-3 --to-hz 2 --out " + at("low") +
                              " --plot " + at("p.svg") + " --spectrogram " + at("s.svg"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_EQ(read_npz(at("low.npz")).frames(), 60);
  for (const char* name : {"low.bvh", "low.html", "p.svg", "s.svg"})
    EXPECT_GT(fs::file_size(at(name)), 100u) << name;
  expect_run("filter " + clip("one") + " --out " + at("x.npz"), 3, "one frame");
  expect_run("filter " + clip("a") + " --from-hz 2 --out " + at("x.npz"), 2, "--keep band");
  expect_run("filter " + clip("a") + " --keep band --from-hz 3 --to-hz 2 --out " + at("x.npz"), 2,
             "from_hz");
  expect_run("filter " + clip("a") + " --out " + clip("a"), 2, "replace");
  expect_run("filter " + clip("a") + " --out " + at("x") + " --json " + clip("a"), 2, "replace");
  EXPECT_FALSE(fs::exists(at("x.npz")));
}

TEST_F(SpectralCommands, InterpolateWritesTheMotion) {
  if (!has_torch()) GTEST_SKIP() << "mocaplm-torch is not built here";
  const Ran ran =
      run_mocaplm("interpolate " + clip("a") + " " + clip("c") + " --fps 20 --steps 5 --out " +
                  at("mid") + " --spectrogram " + at("i.svg") + " --json " + at("i.json"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_EQ(read_npz(at("mid.npz")).frames(), 80);
  EXPECT_EQ(load_json(at("i.json"))["rows"].size(), 3u);
  EXPECT_GT(fs::file_size(at("i.svg")), 100u);
  expect_run("interpolate " + clip("a") + " " + clip("one") + " --out " + at("x.npz"), 3,
             "one frame");
  expect_run("interpolate " + clip("a") + " " + clip("c") + " --from-hz 5 --out " + at("x.npz"), 2,
             "from_hz");
  expect_run("interpolate " + clip("a"), 2, "two motions");
  expect_run("interpolate " + clip("a") + " " + clip("c") + " --pairs 3", 2, "--evaluate");
}

TEST_F(SpectralCommands, InterpolateEvaluatesPairs) {
  if (!has_torch()) GTEST_SKIP() << "mocaplm-torch is not built here";
  const std::string evaluate = "interpolate --data " + at("data") + " --fps 20 --evaluate ";
  const Ran ran = run_mocaplm(evaluate + "genre --pairs 1 --steps 5 --json " + at("t.json"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  const Json tables = load_json(at("t.json"));
  ASSERT_EQ(tables.size(), 3u);
  EXPECT_EQ(tables[0]["rows"].size(), 6u);
  EXPECT_EQ(tables[0]["rows"][0]["features"], "dct");
  EXPECT_EQ(tables[1]["rows"].size(), 1u);
  expect_run(evaluate + "gnre", 2, "did you mean \"genre\"");
  expect_run(evaluate + "genre --target dct", 2, "--target does not go");
  expect_run(evaluate + "genre --split validation", 3, "no two clips");
  expect_run("interpolate --evaluate genre", 2, "--data");
}

}  // namespace
}  // namespace mocaplm::spectral_commands_test
