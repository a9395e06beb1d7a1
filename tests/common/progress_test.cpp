// The plain lines of a progress bar: stderr of a test is no terminal here.
#include "common/progress.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

namespace mocaplm {
namespace {

class ProgressLines : public ::testing::Test {
 protected:
  void SetUp() override {
    if (::isatty(STDERR_FILENO) != 0) GTEST_SKIP() << "stderr is a terminal: no plain lines";
    testing::internal::CaptureStderr();
  }
};

TEST_F(ProgressLines, CountUnitsAndEndWithTheTime) {
  Progress bar("import", 4, "clips", 0);
  for (std::size_t i = 1; i <= 4; ++i) bar.update(i, "note");
  bar.finish();
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("import 2/4 clips"), std::string::npos) << text;
  EXPECT_NE(text.find(" left | note"), std::string::npos) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

TEST_F(ProgressLines, AShareGivesTheTimeLeftInsteadOfTheTotal) {
  using namespace std::chrono_literals;
  Progress bar("train", 100000, "steps", 0);
  bar.update(1, "", 0.25);  // work done before this bar began does not count as its speed
  std::this_thread::sleep_for(200ms);
  bar.update(2, "", 0.5);
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_EQ(text.find("100000"), std::string::npos) << text;
  // A quarter in 0.2 s and half of the work left: 0.4 s, far from the days that steps would say.
  EXPECT_NE(text.find("2 steps"), std::string::npos) << text;
  EXPECT_NE(text.find(" 0 s left"), std::string::npos) << text;
}

}  // namespace
}  // namespace mocaplm
