// emulate fit and sample from the command line: the walk, exit codes, messages.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "motion/formats/formats.h"
#include "support/small_dataset.h"

namespace fs = std::filesystem;

namespace mocaplm::emulate_command_test {
namespace {

class EmulateCommand : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
  void synth() {
    expect_run("synth --out " + at("s") +
                   " --genres WA --dancers 3 --choreographies 2 --seconds 2 --fps 20",
               0, "procedural");
  }
  TemporaryFolder folder_;
};

TEST_F(EmulateCommand, FitAndSample) {
  synth();
  expect_run("emulate fit " + at("s") + " --where genre=waack --split all --iterations 1 --out " +
                 at("m.json") + " --json " + at("t.json"),
             0, "SIEM/SequentialPCA/MVG");
  EXPECT_FALSE(load_json(folder_ / "t.json").at("rows").empty());
  expect_run("info " + at("m.json"), 0, "SIEM/SequentialPCA/MVG");
  const std::string sample = "emulate sample " + at("m.json");
  expect_run(sample + " --count 2 --seed 3 --fps 25 --out " + at("a"), 0, "emulated-2");
  for (const char* name : {"a-1.npz", "a-2.npz", "a-1.bvh", "a-2.bvh", "a.html"})
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  EXPECT_EQ(read_clip(folder_ / "a-2.npz").fps, 25);
  EXPECT_NE(read_file(folder_ / "a.html").find("procedural"), std::string::npos);
  // The same seed, the same bytes; only what the ending names.
  expect_run(sample + " --count 2 --seed 3 --fps 25 --out " + at("b.npz"), 0, "b-2.npz");
  EXPECT_EQ(read_file(folder_ / "b-2.npz"), read_file(folder_ / "a-2.npz"));
  EXPECT_FALSE(fs::exists(folder_ / "b.html"));
  expect_run(sample + " --seed 4 --timing mean --out " + at("c.bvh"), 0, "c.bvh");
}

TEST_F(EmulateCommand, WhatCannotBeIsRefused) {
  synth();
  const std::string fit = "emulate fit " + at("s") + " --out " + at("m.json");
  expect_run("emulate", 2, "give a command");
  expect_run("emulate fit " + at("s"), 2, "--out");
  expect_run(fit + " --where genre=wack", 2, "did you mean \"waack\"");
  expect_run(fit + " --where genres=waack", 2, "no label \"genres\"");
  expect_run(fit + " --scheme SIEM/MVG", 2, "expected Representation");
  expect_run(fit + " --scheme SIEM/SequentialPCA/VAR", 2, "SpatialPCA/VAR go together");
  expect_run(fit + " --heading left", 2, "heading");
  expect_run(fit + " --joints nose", 2, "unknown joint");
  expect_run(fit + " --d1 0", 2, "d1");
  expect_run("emulate fit " + at("none") + " --out " + at("m.json"), 3, "none");
  EXPECT_FALSE(fs::exists(folder_ / "m.json"));
  expect_run("emulate sample " + at("none.json"), 3, "no such file");
  write_file(folder_ / "x.json", "{\"format\": \"mocaplm tokenizer\"}");
  expect_run("emulate sample " + at("x.json") + " --out " + at("y"), 3, "is no emulator");
  EXPECT_FALSE(fs::exists(folder_ / "y.npz"));
}

TEST_F(EmulateCommand, TooLittleToFitToIsNamed) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 7; ++i)
    clips.push_back({"clip" + std::to_string(i),
                     i < 2 ? "test" : "train",
                     i == 6 ? 1 : 12,
                     {{"content", i < 5    ? "walk"
                                  : i == 5 ? "jump"
                                           : "stand"}}});
  write_dataset(folder_ / "d", clips);
  const std::string fit = "emulate fit " + at("d") + " --out " + at("m.json") +
                          " --align none --frames 8 --scheme SIEM/SequentialPCA/MVG ";
  expect_run(fit + "--where content=jump", 3, "content=jump has 1 clip in the split train");
  expect_run(fit + "--where content=walk --split test", 3, "has 2 clips in the split test");
  expect_run(fit + "--where content=stand --split all", 3, "has 1 clip, expected 3 or more");
  expect_run(fit + "--split all", 3, "clip6: a clip of one frame is no motion");
  EXPECT_FALSE(fs::exists(folder_ / "m.json"));
  // Fewer clips than components: as many as there are, and it is said.
  expect_run(fit + "--where content=walk --split all", 0, "10 x 4");
  expect_run(fit + "--where content=walk --split all", 0, "fewer components than asked for");
}

}  // namespace
}  // namespace mocaplm::emulate_command_test
