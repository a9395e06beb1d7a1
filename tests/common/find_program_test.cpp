#include "common/find_program.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "common/files.h"
#include "common/temporary_folder.h"

namespace fs = std::filesystem;

namespace mocaplm::find_program_test {
namespace {

TEST(FindProgram, TakesTheFirstOnThePathThatMayBeRun) {
  const TemporaryFolder folder;
  for (const char* name : {"a/tool", "b/tool", "c/tool"}) write_file(folder / name, "#!/bin/sh\n");
  fs::create_directories(folder / "d/tool");  // a folder is no program
  for (const char* name : {"b/tool", "c/tool"})
    fs::permissions(folder / name, fs::perms::owner_exec, fs::perm_options::add);
  const std::string before = std::getenv("PATH");
  std::string path;
  for (const char* name : {"d", "", "a", "b", "c"}) path += (folder / name).string() + ":";
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(find_program("tool"), folder / "b/tool");
  EXPECT_EQ(find_program("other"), "");
  ::unsetenv("PATH");
  EXPECT_EQ(find_program("tool"), "");
  ::setenv("PATH", before.c_str(), 1);
}

}  // namespace
}  // namespace mocaplm::find_program_test
