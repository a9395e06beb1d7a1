// Threads that run, wait for each other, sleep and wake.
#include "generate/team.h"

#include <gtest/gtest.h>

#include <chrono>

namespace mocaplm::team_test {

namespace {

TEST(Team, EveryThreadRunsOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    Team team(threads);
    ASSERT_EQ(team.size(), threads);
    for (int round = 0; round < 200; ++round) {
      std::vector<int> runs(static_cast<std::size_t>(threads), 0);
      team.run([&](int thread) { ++runs[static_cast<std::size_t>(thread)]; });
      for (const int count : runs) ASSERT_EQ(count, 1);
    }
  }
}

// What others wrote before a barrier is seen after it, many barriers long.
TEST(Team, ABarrierWaitsForAll) {
  for (const int threads : {1, 2, 5}) {
    Team team(threads);
    std::vector<int> values(static_cast<std::size_t>(threads), 0);
    std::atomic<int> wrong{0};
    team.run([&](int thread) {
      for (int round = 1; round <= 300; ++round) {
        values[static_cast<std::size_t>(thread)] = round;
        team.barrier();
        for (const int value : values) wrong += value != round;
        team.barrier();
      }
    });
    EXPECT_EQ(wrong, 0) << threads;
  }
}

TEST(Team, WakesFromSleep) {
  Team team(2);
  std::atomic<int> runs{0};
  for (int round = 0; round < 5; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    team.run([&](int) { ++runs; });
  }
  EXPECT_EQ(runs, 10);
}

TEST(Team, ZeroIsOneThreadACore) {
  EXPECT_EQ(Team(0).size(), static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

}  // namespace

}  // namespace mocaplm::team_test
