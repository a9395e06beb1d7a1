// The commands of docs/tutorial.md, run one after the other as they stand there, on recordings of
// two kinds; only the minutes of training are fewer.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/formats/formats.h"

namespace fs = std::filesystem;

namespace mocaplm::tutorial_test {
namespace {

std::vector<std::string> shell_blocks(const fs::path& document) {
  static const std::regex block("```sh\n([^`]*)```");
  const std::string text = read_file(document);
  std::vector<std::string> blocks;
  for (std::sregex_iterator one(text.begin(), text.end(), block), end; one != end; ++one)
    blocks.push_back(one->str(1));
  return blocks;
}

// Procedural dances stand in for somebody's recordings: .bvh files in a folder for each kind.
void record(const fs::path& folder) {
  const Ran ran = run_mocaplm("synth --out '" + (folder / "dances").string() +
                              "' --genres WA,HO --dancers 3 --choreographies 2 --seconds 8");
  ASSERT_EQ(ran.code, 0) << ran.text;
  int waltzes = 0, houses = 0;
  for (const auto& entry : fs::directory_iterator(folder / "dances" / "clips")) {
    const Clip clip = read_clip(entry.path());
    const bool house = entry.path().filename().string().rfind("gHO", 0) == 0;
    char name[40];
    std::snprintf(name, sizeof name, house ? "house/ben_%02d.bvh" : "waltz/anna_%02d.bvh",
                  house ? ++houses : ++waltzes);
    fs::create_directories((folder / "mocap" / name).parent_path());
    write_clip(folder / "mocap" / name, clip);
  }
  ASSERT_GE(std::min(waltzes, houses), 3);
}

TEST(Tutorial, RunsAsWritten) {
  const TemporaryFolder folder;
  record(folder.path());
  fs::create_directory_symlink(fs::path(MOCAPLM_SOURCE_DIR) / "configs", folder / "configs");
  fs::create_directory_symlink(MOCAPLM_BINARY_DIR, folder / "build");
  const std::vector<std::string> blocks =
      shell_blocks(fs::path(MOCAPLM_SOURCE_DIR) / "docs" / "tutorial.md");
  ASSERT_GT(blocks.size(), 6u);
  std::string path;
  for (const std::string& block : blocks) {
    const std::string hasty =
        std::regex_replace(block, std::regex("--max-minutes [0-9.]+"), "--max-minutes 0.04");
    // `export` lasts for the blocks that follow.
    if (hasty.rfind("export", 0) == 0) {
      path = hasty;
      continue;
    }
    const Ran ran =
        run_shell("cd '" + folder.path().string() + "' && " + path + "set -e; " + hasty);
    ASSERT_EQ(ran.code, 0) << block << ran.text;
  }
  for (const char* made : {"look.html", "free.bvh", "goes-on.html", "from-an-arm.npz", "three.html",
                           "runs/base/training.html"})
    EXPECT_TRUE(fs::exists(folder / made)) << made;
  EXPECT_NEAR(read_clip(folder / "goes-on.npz").seconds(), 4 + 20, 0.06);  // prompt, and more
}

}  // namespace
}  // namespace mocaplm::tutorial_test
