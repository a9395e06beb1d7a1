// The plain lines of a progress bar, and the one that moves on a terminal.
#include "common/progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

namespace mocaplm::progress_test {
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

// stderr becomes a terminal of `columns` columns; returns what `act` writes there.
template <class Act>
std::string on_terminal(unsigned short columns, const Act& act) {
  const int ours = ::posix_openpt(O_RDWR | O_NOCTTY);
  EXPECT_TRUE(ours >= 0 && ::grantpt(ours) == 0 && ::unlockpt(ours) == 0);
  const int theirs = ::open(::ptsname(ours), O_RDWR | O_NOCTTY);
  winsize size{};
  size.ws_row = 24;
  size.ws_col = columns;
  EXPECT_EQ(::ioctl(theirs, TIOCSWINSZ, &size), 0);
  std::fflush(stderr);
  const int kept = ::dup(STDERR_FILENO);
  ::dup2(theirs, STDERR_FILENO);
  act();
  std::fflush(stderr);
  ::dup2(kept, STDERR_FILENO);
  ::close(kept);
  std::string text;
  pollfd wait{ours, POLLIN, 0};
  while (::poll(&wait, 1, 100) > 0) {
    char buffer[4096];
    const ssize_t count = ::read(ours, buffer, sizeof buffer);
    if (count <= 0) break;
    text.append(buffer, static_cast<std::size_t>(count));
  }
  ::close(theirs);
  ::close(ours);
  return text;
}

class ProgressOnTerminal : public ::testing::Test {
 protected:
  void SetUp() override { ::setenv("TERM", "xterm", 1); }
};

TEST_F(ProgressOnTerminal, IsOneLineThatMoves) {
  const std::string text = on_terminal(100, [] {
    Progress bar("import", 4, "clips");
    bar.update(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(120));
    bar.update(2, "walk.bvh");
    bar.finish();
  });
  EXPECT_NE(text.find("\r\033[Kimport [######"), std::string::npos) << text;
  EXPECT_NE(text.find("2/4 clips, "), std::string::npos) << text;
  EXPECT_NE(text.find("/s, "), std::string::npos) << text;
  EXPECT_NE(text.find(" left | walk.bvh"), std::string::npos) << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;  // at its end
}

TEST_F(ProgressOnTerminal, NeverWrapsWhileItMoves) {
  const std::string text = on_terminal(30, [] {
    Progress bar("import", 4, "clips");
    bar.update(1, std::string(200, 'x'));
    std::fputs("\r", stderr);
  });
  std::size_t most = 0, begin = 0;
  for (std::size_t at = 0; at < text.size(); ++at)
    if (text[at] == '\r') {
      const std::string line = text.substr(begin, at - begin);
      most = std::max(most, line.size() - (line.find("\033[K") == 0 ? 3 : 0));
      begin = at + 1;
    }
  EXPECT_EQ(most, 29u) << text;
}

TEST_F(ProgressOnTerminal, IsPlainWhereNothingMoves) {
  ::setenv("TERM", "dumb", 1);
  const std::string text = on_terminal(80, [] {
    Progress bar("import", 4, "clips", 0);
    bar.update(2);
  });
  EXPECT_EQ(text.find('\033'), std::string::npos) << text;
  EXPECT_NE(text.find("import 2/4 clips"), std::string::npos) << text;
}

TEST_F(ProgressLines, OfARunThatGoesOnCountWhatItDidItself) {
  Progress bar("train", 2000, "steps", 0);
  bar.start_from(1000);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  bar.update(1001);
  const std::string text = testing::internal::GetCapturedStderr();
  // At most 5 steps a second, so 999 of them take minutes.
  EXPECT_NE(text.find("train 1001/2000 steps, "), std::string::npos) << text;
  const double rate = std::stod(text.substr(text.find("steps, ") + 7));
  EXPECT_LE(rate, 5) << text;
  EXPECT_NE(text.find(':', text.find("/s, ")), std::string::npos) << text;
}

}  // namespace
}  // namespace mocaplm::progress_test
