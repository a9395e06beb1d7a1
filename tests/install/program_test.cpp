// cmake --install puts programs, manual page and completions where they belong, and they work
// there.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "app/command_line.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"

namespace fs = std::filesystem;

namespace mocaplm::program_test {
namespace {

TEST(Install, GivesProgramsManualAndCompletions) {
  if (std::system("command -v cmake > /dev/null 2>&1") != 0) GTEST_SKIP() << "cmake is not here";
  TemporaryFolder folder;
  const Ran ran = run_shell("cmake --install '" MOCAPLM_BINARY_DIR "' --prefix '" +
                            folder.path().string() + "'");
  ASSERT_EQ(ran.code, 0) << ran.text;
  const fs::path share = folder / "share";
  EXPECT_TRUE(contains(read_file(share / "man/man1/mocaplm.1"), ".SS mocaplm generate"));
  EXPECT_TRUE(contains(read_file(share / "bash-completion/completions/mocaplm"),
                       "complete -F _mocaplm mocaplm"));
  EXPECT_TRUE(contains(read_file(share / "zsh/site-functions/_mocaplm"), "#compdef mocaplm"));
  const std::string program = (folder / "bin/mocaplm").string();
  const Ran version = run_program(program, "--version");
  EXPECT_EQ(version.code, 0) << version.text;
  EXPECT_TRUE(contains(version.text, "LibTorch: ")) << version.text;
  EXPECT_FALSE(contains(version.text, "does not work")) << version.text;
  const Ran train = run_program(program, "train --help");
  EXPECT_EQ(train.code, 0) << train.text;
  EXPECT_TRUE(contains(train.text, "--n-layer")) << train.text;
}

}  // namespace
}  // namespace mocaplm::program_test
