#include "motion/formats/bvh_frame_rate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace mocaplm::bvh_frame_rate_test {
namespace {

FrameRate rate_of(const std::string& digits) {
  return frame_rate(std::stod(digits), digits);
}

TEST(BvhFrameRate, FewDigitsMeanTheUsualRateAndAreSaid) {
  const std::vector<std::pair<std::string, double>> cases = {
      {"0.033", 30},  {"0.03", 30},    {".033", 30},  {"0.0333", 30}, {"33.3e-3", 30},
      {"0.017", 60},  {"0.0167", 60},  {"0.016", 60}, {"0.0166", 60}, {"1.7E-02", 60},
      {"0.008", 120}, {"0.0083", 120}, {"0.042", 24}, {"0.041", 24},  {"0.0417", 24},
      {"0.004", 240}, {"0.0042", 240}, {"0.011", 90}, {"0.0111", 90}, {"0.067", 15}};
  for (const auto& [digits, fps] : cases) {
    EXPECT_EQ(rate_of(digits).fps, fps) << digits;
    EXPECT_TRUE(rate_of(digits).guessed) << digits;
  }
}

TEST(BvhFrameRate, WhatTheDigitsDetermineIsNotSaid) {
  const std::vector<std::pair<std::string, double>> cases = {
      {"0.04", 25},       {".04", 25},         {"0.02", 50},
      {"0.01", 100},      {"0.005", 200},      {"0.0333333", 30},
      {"0.033333", 30},   {"0.03333", 30},     {"0.00833333", 120},
      {"0.0083333", 120}, {"0.01667", 60},     {"0.01666667", 60},
      {"0.041667", 24},   {"0.00416667", 240}, {"8.333333333e-3", 120},
      {"0.5", 2},         {"2", 0.5},          {"1", 1},
      {"0.008000", 125},  {"0.0400000", 25}};
  for (const auto& [digits, fps] : cases) {
    EXPECT_NEAR(rate_of(digits).fps, fps, 1e-9 * fps) << digits;
    EXPECT_FALSE(rate_of(digits).guessed) << digits;
  }
  // 23.976 is not 24, and 29.97 is not 30.
  EXPECT_NEAR(rate_of("0.041708").fps, 23.976, 1e-3);
  EXPECT_NEAR(rate_of("0.033367").fps, 29.97, 1e-3);
  EXPECT_NEAR(rate_of("0.01668").fps, 59.94, 0.02);
}

// Whatever program wrote it: a common rate, rounded by printf to any number of digits of which two
// count, comes back; and one that is not guessed has the written time to its last digit.
TEST(BvhFrameRate, RoundedTimesOfCommonRatesComeBack) {
  for (const double fps : {24., 25., 30., 50., 60., 90., 100., 120., 240.})
    for (int digits = 3; digits <= 12; ++digits) {
      char text[32];
      std::snprintf(text, sizeof text, "%.*f", digits, 1 / fps);
      if (std::stod(text) * fps < 0.93 || std::stod(text) * fps > 1.07) continue;
      EXPECT_EQ(rate_of(text).fps, fps) << text;
    }
  for (int step = 10; step < 2000; ++step) {
    const std::string digits = "0.0" +
                               std::string(step < 100    ? "00"
                                           : step < 1000 ? "0"
                                                         : "") +
                               std::to_string(step);
    const FrameRate rate = rate_of(digits);
    EXPECT_LT(std::abs(1 / rate.fps - std::stod(digits)), 1.0001e-5) << digits;
    if (!rate.guessed) EXPECT_NEAR(rate.fps * std::stod(digits), 1, 1.0001e-3) << digits;
  }
}

}  // namespace
}  // namespace mocaplm::bvh_frame_rate_test
