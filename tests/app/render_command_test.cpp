// render as it is called: a picture, a dataset's clip, refusals. What is drawn is tested in
// tests/render.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace mocaplm::render_command_test {
namespace {

class RenderCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    write_dataset(*folder_ / "data", {{"a", "train", 30}, {"b", "test", 10}});
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string at(const std::string& name) { return (*folder_ / name).string(); }
  static std::string small(const std::string& out) {
    return " --out " + at(out) + " --width 160 --height 120 ";
  }
  static void refused(const std::string& arguments, int code, const std::string& part) {
    expect_run("render " + arguments, code, part);
  }

  static TemporaryFolder* folder_;
};

TemporaryFolder* RenderCommand::folder_ = nullptr;

TEST_F(RenderCommand, DrawsAClip) {
  Ran ran = run_mocaplm("render " + at("data/clips/a.npz") + ":0.5-" + small("a.png") +
                        "--poses 3 --turn 40 --json " + at("a.json"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_EQ(read_file(at("a.png")).substr(1, 3), "PNG");
  EXPECT_EQ(load_json(at("a.json"))["rows"][3]["value"], 1);
  ran = run_mocaplm("render " + at("data") + " --clip b" + small("b.png") + "--at 0.3 --dark");
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_NE(read_file(at("a.png")), read_file(at("b.png")));
}

TEST_F(RenderCommand, RefusesWhatCannotBe) {
  refused(at("data") + small("x.png"), 2, "--clip");
  refused(at("data") + " --clip c" + small("x.png"), 2, "no clip is named");
  refused(at("data/clips/b.npz") + small("x.avi"), 2, ".mp4");
  refused(at("data/clips/b.npz") + small("x.png") + "--at 2", 2, "0.50 s");
  refused(at("none.npz") + small("x.png"), 3, "none.npz");
  refused(at("data/clips/b.npz") + small("x.png") + "--json " + at("data/clips/b.npz"), 2,
          "is read");
  refused(at("data/clips/b.npz") + small("x.png") + "--json " + at("x.png"), 2, "twice");
  const Ran ran = run_shell("PATH=/nowhere " MOCAPLM_BINARY_DIR "/mocaplm render " +
                            at("data/clips/b.npz") + small("x.mp4"));
  EXPECT_EQ(ran.code, 2) << ran.text;
  EXPECT_TRUE(contains(ran.text, "apt-get install ffmpeg")) << ran.text;
  EXPECT_FALSE(std::filesystem::exists(at("x.png")));
  EXPECT_FALSE(std::filesystem::exists(at("x.mp4")));
}

}  // namespace
}  // namespace mocaplm::render_command_test
