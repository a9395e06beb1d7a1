// emulate fit and sample from the command line: the walk, exit codes, messages.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "motion/formats/formats.h"
#include "temporary_folder.h"

namespace fs = std::filesystem;

namespace mocaplm {
namespace {

class EmulateCommand : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
  void expect(const std::string& arguments, int code, const std::string& part) {
    const Ran ran = run_mocaplm(arguments);
    EXPECT_EQ(ran.code, code) << arguments << "\n" << ran.text;
    EXPECT_NE(ran.text.find(part), std::string::npos) << arguments << "\n" << ran.text;
  }
  void synth() {
    expect("synth --out " + at("s") +
               " --genres WA --dancers 3 --choreographies 2 --seconds 2 --fps 20",
           0, "procedural");
  }
  TemporaryFolder folder_;
};

TEST_F(EmulateCommand, FitAndSample) {
  synth();
  expect("emulate fit " + at("s") + " --where genre=waack --split all --iterations 1 --out " +
             at("m.json") + " --json " + at("t.json"),
         0, "SIEM/SequentialPCA/MVG");
  EXPECT_FALSE(load_json(folder_ / "t.json").at("rows").empty());
  expect("info " + at("m.json"), 0, "SIEM/SequentialPCA/MVG");
  const std::string sample = "emulate sample " + at("m.json");
  expect(sample + " --count 2 --seed 3 --fps 25 --out " + at("a"), 0, "emulated-2");
  for (const char* name : {"a-1.npz", "a-2.npz", "a-1.bvh", "a-2.bvh", "a.html"})
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  EXPECT_EQ(read_clip(folder_ / "a-2.npz").fps, 25);
  EXPECT_NE(read_file(folder_ / "a.html").find("procedural"), std::string::npos);
  // The same seed, the same bytes; only what the ending names.
  expect(sample + " --count 2 --seed 3 --fps 25 --out " + at("b.npz"), 0, "b-2.npz");
  EXPECT_EQ(read_file(folder_ / "b-2.npz"), read_file(folder_ / "a-2.npz"));
  EXPECT_FALSE(fs::exists(folder_ / "b.html"));
  expect(sample + " --seed 4 --timing mean --out " + at("c.bvh"), 0, "c.bvh");
}

TEST_F(EmulateCommand, WhatCannotBeIsRefused) {
  synth();
  const std::string fit = "emulate fit " + at("s") + " --out " + at("m.json");
  expect("emulate", 2, "subcommand");
  expect("emulate fit " + at("s"), 2, "--out");
  expect(fit + " --where genre=wack", 2, "did you mean \"waack\"");
  expect(fit + " --where genres=waack", 2, "no label \"genres\"");
  expect(fit + " --scheme SIEM/MVG", 2, "expected Representation");
  expect(fit + " --scheme SIEM/SequentialPCA/VAR", 2, "SpatialPCA/VAR go together");
  expect(fit + " --heading left", 2, "heading");
  expect(fit + " --joints nose", 2, "unknown joint");
  expect(fit + " --d1 0", 2, "d1");
  expect("emulate fit " + at("none") + " --out " + at("m.json"), 3, "none");
  EXPECT_FALSE(fs::exists(folder_ / "m.json"));
  expect("emulate sample " + at("none.json"), 3, "no such file");
  write_file(folder_ / "x.json", "{\"format\": \"mocaplm tokenizer\"}");
  expect("emulate sample " + at("x.json") + " --out " + at("y"), 3, "is no emulator");
  EXPECT_FALSE(fs::exists(folder_ / "y.npz"));
}

}  // namespace
}  // namespace mocaplm
