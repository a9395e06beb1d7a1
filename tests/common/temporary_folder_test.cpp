#include "common/temporary_folder.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include "common/files.h"
#include "support/refusal.h"

namespace fs = std::filesystem;

namespace mocaplm::temporary_folder_test {
namespace {

TEST(TemporaryFolder, IsOnesOwnAndGoesWithAllThatIsInIt) {
  fs::path first;
  {
    const TemporaryFolder one, other;
    first = one.path();
    EXPECT_NE(one.path(), other.path());
    EXPECT_EQ(fs::status(first).permissions(), fs::perms::owner_all);
    write_file(one / "sub/file", "x");
    EXPECT_EQ(read_file(first / "sub" / "file"), "x");
  }
  EXPECT_FALSE(fs::exists(first));
}

TEST(TemporaryFolder, SaysWhyThereIsNone) {
  const char* before = ::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  const TemporaryFolder there;
  ::setenv("TMPDIR", (there / "nowhere").c_str(), 1);
  EXPECT_TRUE(contains(refusal([] { TemporaryFolder(); }), "TMPDIR"));
  if (before == nullptr)
    ::unsetenv("TMPDIR");
  else
    ::setenv("TMPDIR", kept.c_str(), 1);
}

}  // namespace
}  // namespace mocaplm::temporary_folder_test
