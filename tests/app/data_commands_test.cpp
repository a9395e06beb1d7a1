// synth, import and info from the command line: exit codes, messages, files left alone.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"

namespace fs = std::filesystem;

namespace mocaplm::data_commands_test {
namespace {

const std::string kSmall = " --genres WA --dancers 1 --choreographies 1 --seconds 1";

class DataCommands : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
  TemporaryFolder folder_;
};

TEST_F(DataCommands, UsageErrorsExitWithTwo) {
  expect_run("", 2, "give a command");
  expect_run("dance", 2, "dance");
  expect_run("import", 2, "required");
  expect_run("import x", 2, "--out");
  expect_run("import x --out y --fps abc", 2, "fps");
  expect_run("import x --out y --fps nan", 2, "fps");
  expect_run("import x --out y --fps -1", 2, "fps");
  expect_run("import x --out y --up w", 2, "up");
  expect_run("import x --out y --nonsense", 2, "nonsense");
  expect_run("import x --out y --append --overwrite", 2, "excludes");
  expect_run("import x --out y --split 1,1,1", 2, "--split");
  expect_run("synth", 2, "--out");
  expect_run("synth --out " + at("s") + " --seed x", 2, "seed");
  expect_run("synth --out " + at("s") + " --genres WX", 2, "no genre \"WX\"");
  expect_run("synth --out " + at("s") + " --seconds 1e9", 2, "seconds");
  expect_run("synth --out " + at("s") + " --dancers 4", 2, "dancers");
  expect_run("info", 2, "PATH");
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(DataCommands, HelpAndVersionExitWithZero) {
  expect_run("--help", 0, "import");
  expect_run("--version", 0, "mocaplm ");
  expect_run("import --help", 0, "--label-regex");
  expect_run("synth --help", 0, "--seed");
  expect_run("info --help", 0, "PATH");
}

TEST_F(DataCommands, MissingAndBrokenFilesExitWithThree) {
  expect_run("import " + at("none") + " --out " + at("o"), 3, "none: no such file");
  expect_run("info " + at("none"), 3, "none: no such file");
  fs::create_directories(folder_ / "in");
  expect_run("import " + at("in") + " --out " + at("o"), 3,
             "no .npz, .pkl, .bvh or other motion file");
  expect_run("info " + at("in"), 3, "neither a dataset");
  write_file(folder_ / "in" / "a.bvh", "HIERARCHY\nROOT");
  expect_run("import " + at("in") + " --out " + at("o"), 3, "nothing was written");
  expect_run("import " + at("in") + " --out " + at("o") + " --strict", 3, "a.bvh: line 2");
  expect_run("info " + at("in/a.bvh"), 3, "a.bvh: line 2");
  for (const char* name : {"x.npz", "x.pkl", "x.bvh", "x.json", "dataset.json", "config.json"})
    for (const std::string& content :
         {std::string(), std::string("{"), std::string("{}"), std::string(5000, '\0'),
          std::string("PK\3\4") + std::string(100, '\xff')}) {
      write_file(folder_ / "b" / name, content);
      expect_run("info " + at(std::string("b/") + name), 3, name);
    }
  write_file(folder_ / "c.txt", "x");
  expect_run("import " + at("c.txt") + " --out " + at("o"), 2, "not a motion file");
  EXPECT_FALSE(fs::exists(folder_ / "o"));
}

TEST_F(DataCommands, SynthImportInfoWalk) {
  expect_run("synth --out " + at("s") + kSmall, 0, "procedural");
  expect_run("synth --out " + at("s") + kSmall, 2, "--overwrite");
  expect_run("synth --out " + at("s") + kSmall + " --overwrite", 0, "procedural");
  expect_run("info " + at("s") + " --json " + at("i.json"), 0, "Procedural dances");
  EXPECT_EQ(load_json(folder_ / "i.json").size(), 2u);

  expect_run("import " + at("s/clips") + " --out " + at("d") + " --json " + at("d.json"), 0,
             "2 clips");
  EXPECT_EQ(load_json(folder_ / "d.json")["imported"], 2);
  expect_run("info " + at("d"), 0, "waack (2)");

  // One broken file among sound ones: the others are written, the exit code says so.
  fs::copy(folder_ / "s" / "clips", folder_ / "in");
  write_file(folder_ / "in" / "broken.npz", "PK");
  expect_run("import " + at("in") + " --out " + at("d"), 2, "--overwrite replaces it");
  expect_run("import " + at("in") + " --out " + at("d") + " --overwrite", 3, "1 of 3 files");
  expect_run("info " + at("d"), 0, "waack (2)");
  expect_run("import " + at("in") + " --out " + at("d") + " --overwrite --strict", 3, "broken.npz");
  expect_run("info " + at("d"), 0, "waack (2)");
}

TEST_F(DataCommands, FoldersOfOthersAreLeftAlone) {
  write_file(folder_ / "mine" / "notes.txt", "mine");
  expect_run("synth --out " + at("mine") + kSmall + " --overwrite", 3, "not a dataset");
  write_file(folder_ / "file", "mine");
  expect_run("synth --out " + at("file") + kSmall, 3, "file");
  EXPECT_EQ(read_file(folder_ / "mine" / "notes.txt"), "mine");
  EXPECT_EQ(read_file(folder_ / "file"), "mine");
  expect_run("synth --out " + at("s") + kSmall, 0, "procedural");
  expect_run("import " + at("s") + " --out " + at("s") + " --overwrite", 2, "lies inside --out");
  expect_run("info " + at("s"), 0, "waack (2)");
}

}  // namespace
}  // namespace mocaplm::data_commands_test
