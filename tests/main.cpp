// The main of every test program: that of GoogleTest, with --file=NAME_test.cpp for the tests of
// one file of the directory.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace {

// The names of the tests that a file holds, as a filter; "" when there is none.
std::string tests_of(const std::string& file) {
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  std::string filter;
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int k = 0; k < suite.total_test_count(); ++k) {
      const testing::TestInfo& test = *suite.GetTestInfo(k);
      if (std::filesystem::path(test.file()).filename() == file)
        filter += (filter.empty() ? "" : ":") + std::string(suite.name()) + "." + test.name();
    }
  }
  return filter;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string option = "--file=";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::string filter =
        word.rfind(option, 0) == 0 ? tests_of(word.substr(option.size())) : "";
    if (filter.empty()) {
      std::fprintf(stderr, "%s: no tests; --file=NAME_test.cpp chooses those of a file\n",
                   word.c_str());
      return 2;
    }
    testing::GTEST_FLAG(filter) = filter;
  }
  return RUN_ALL_TESTS();
}
