#include "common/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace mocaplm::parallel_test {
namespace {

TEST(Parallel, EveryIndexOnce) {
  for (const std::int64_t threads : {0, 1, 2, 7, 100}) {
    std::vector<std::atomic<int>> calls(53);
    parallel_for(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
  }
  parallel_for(0, 4, [](std::size_t) { FAIL(); });
}

TEST(Parallel, ThrowsTheErrorOfTheLowestIndex) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> done{0};
    try {
      parallel_for(1000, 4, [&](std::size_t i) {
        ++done;
        if (i >= 10) throw std::runtime_error(std::to_string(i));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "10");
    }
    EXPECT_LT(done, 20);
  }
}

}  // namespace
}  // namespace mocaplm::parallel_test
