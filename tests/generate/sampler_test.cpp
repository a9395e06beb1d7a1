// The sampler's choices: their frequencies against the probabilities that the settings ask for.
#include "generate/sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/refusal.h"

namespace mocaplm::sampler_test {

namespace {

constexpr std::int32_t kFirst = 4, kCount = 12;

// 20 logits; the largest ones lie outside the ids that may come.
std::vector<float> some_logits() {
  Random random(1);
  std::vector<float> logits;
  for (int i = 0; i < 20; ++i) logits.push_back(static_cast<float>(1.5 * random.normal()));
  logits[0] = logits[3] = logits[16] = logits[19] = 50;
  return logits;
}

SamplingConfig config(double temperature = 1, std::int64_t top_k = 0, double top_p = 1) {
  SamplingConfig c;
  c.temperature = temperature;
  c.top_k = top_k;
  c.top_p = top_p;
  c.seed = 5;
  return c;
}

// Probabilities of the allowed ids, from the definitions.
std::vector<double> expected(const SamplingConfig& c) {
  const std::vector<float> logits = some_logits();
  std::vector<std::pair<double, int>> order;
  double total = 0;
  for (int i = 0; i < kCount; ++i) {
    const double p = std::exp(logits[static_cast<std::size_t>(kFirst + i)] / c.temperature);
    order.emplace_back(-p, i);
    total += p;
  }
  std::sort(order.begin(), order.end());
  std::vector<double> result(kCount, 0.0);
  double before = 0;  // probability of the more likely ids
  for (int rank = 0; rank < kCount; ++rank) {
    const auto [negative, i] = order[static_cast<std::size_t>(rank)];
    const bool kept = (c.top_k == 0 || rank < c.top_k) && (rank == 0 || before < c.top_p);
    if (kept) result[static_cast<std::size_t>(i)] = -negative;
    before -= negative / total;
  }
  double sum = 0;
  for (const double p : result) sum += p;
  for (double& p : result) p /= sum;
  return result;
}

// Pearson's statistic of many draws; impossible ids must not come at all.
void expect_frequencies(const SamplingConfig& c) {
  SCOPED_TRACE(settings_json(c).dump());
  const std::vector<double> p = expected(c);
  const std::vector<float> logits = some_logits();
  Sampler sampler(c);
  std::vector<int> seen(kCount, 0);
  constexpr int kDraws = 40000;
  for (int i = 0; i < kDraws; ++i) {
    const std::int32_t id = sampler.pick(logits, kFirst, kCount);
    ASSERT_GE(id, kFirst);
    ASSERT_LT(id, kFirst + kCount);
    ++seen[static_cast<std::size_t>(id - kFirst)];
  }
  double chi = 0, freedom = -1;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i] == 0) {
      EXPECT_EQ(seen[i], 0) << i;
      continue;
    }
    chi += std::pow(seen[i] - kDraws * p[i], 2) / (kDraws * p[i]);
    ++freedom;
  }
  EXPECT_LT(chi, freedom + 5 * std::sqrt(2 * freedom) + 8);
}

TEST(Sampler, FrequenciesAreTheProbabilities) {
  expect_frequencies(config());
  expect_frequencies(config(0.7));
  expect_frequencies(config(3));
}

TEST(Sampler, TopKAndTopPCutTheTail) {
  for (const std::int64_t k : {1, 2, 5, 11, 12, 100}) expect_frequencies(config(1, k));
  for (const double p : {0.000001, 0.3, 0.6, 0.9, 0.99, 1.0}) expect_frequencies(config(1, 0, p));
  expect_frequencies(config(1.5, 6, 0.7));
  expect_frequencies(config(0.5, 3, 0.999));
}

TEST(Sampler, GreedyTakesTheMostLikelyAllowedId) {
  const std::vector<float> logits = some_logits();
  SamplingConfig c = config(100);
  c.strategy = "greedy";
  Sampler sampler(c);
  const auto best = std::max_element(logits.begin() + kFirst, logits.begin() + kFirst + kCount);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(sampler.pick(logits, kFirst, kCount), best - logits.begin());
  EXPECT_EQ(sampler.pick(std::vector<float>(20, 1.f), kFirst, kCount), kFirst);
  EXPECT_EQ(sampler.pick(logits, 7, 1), 7);
}

TEST(Sampler, ColdIsGreedyAndHotIsUniform) {
  const std::vector<float> logits = some_logits();
  SamplingConfig greedy = config();
  greedy.strategy = "greedy";
  const std::int32_t best = Sampler(greedy).pick(logits, kFirst, kCount);
  Sampler cold(config(0.01)), hot(config(100));
  std::vector<int> seen(kCount, 0);
  for (int i = 0; i < 12000; ++i) {
    EXPECT_EQ(cold.pick(logits, kFirst, kCount), best);
    ++seen[static_cast<std::size_t>(hot.pick(logits, kFirst, kCount) - kFirst)];
  }
  for (const int count : seen) EXPECT_NEAR(count, 1000, 200);
}

TEST(Sampler, RepeatsBySeed) {
  const std::vector<float> logits = some_logits();
  const auto draw = [&](std::int64_t seed) {
    SamplingConfig c = config(2);
    c.seed = seed;
    Sampler sampler(c);
    std::vector<std::int32_t> ids;
    for (int i = 0; i < 50; ++i) ids.push_back(sampler.pick(logits, kFirst, kCount));
    return ids;
  };
  EXPECT_EQ(draw(1), draw(1));
  EXPECT_NE(draw(1), draw(2));
}

TEST(Sampler, SettingsOutOfRangeAreUsageErrors) {
  for (const SamplingConfig& bad : {config(0), config(-1), config(std::nan("")), config(101),
                                    config(1, -1), config(1, 0, 0), config(1, 0, 1.5)})
    EXPECT_THROW(Sampler{bad}, UsageError) << settings_json(bad);
  SamplingConfig bad = config();
  bad.strategy = "beam";
  EXPECT_TRUE(contains(refusal<UsageError>([&] { Sampler{bad}; }), "strategy"));
}

TEST(Sampler, LogitsThatAreNotFiniteAreRefused) {
  for (const float odd : {std::nanf(""), std::numeric_limits<float>::infinity()})
    for (const char* strategy : {"sample", "greedy"}) {
      SamplingConfig c = config();
      c.strategy = strategy;
      Sampler sampler(c);
      std::vector<float> logits = some_logits();
      logits[9] = odd;
      EXPECT_THROW(sampler.pick(logits, kFirst, kCount), DataError);
      EXPECT_EQ(sampler.pick(logits, 10, 1), 10);  // not among the ids that may come
    }
}

}  // namespace

}  // namespace mocaplm::sampler_test
