// Attention over the cache against the plain softmax average, whatever was there before.
#include "generate/kernels/cache.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/kernel_levels.h"
#include "support/random_numbers.h"

namespace mocaplm::cache_test {

namespace {

class Cache : public EveryKernel {};
INSTANTIATE_TEST_SUITE_P(Levels, Cache, all_levels(), level_name);

// softmax(query . keys / sqrt(width)) values over the first `count` rows of (.., width) lists.
std::vector<double> softmax_average(const float* query, const std::vector<float>& keys,
                                    const std::vector<float>& values, std::int64_t count,
                                    std::int64_t width) {
  std::vector<double> p, out(static_cast<std::size_t>(width), 0.0);
  double total = 0;
  for (std::int64_t t = 0; t < count; ++t) {
    double score = 0;
    for (std::int64_t i = 0; i < width; ++i)
      score += static_cast<double>(query[i]) * keys[static_cast<std::size_t>(t * width + i)];
    p.push_back(std::exp(score / std::sqrt(static_cast<double>(width))));
    total += p.back();
  }
  for (std::int64_t t = 0; t < count; ++t)
    for (std::int64_t i = 0; i < width; ++i)
      out[static_cast<std::size_t>(i)] +=
          p[static_cast<std::size_t>(t)] / total * values[static_cast<std::size_t>(t * width + i)];
  return out;
}

TEST_P(Cache, AttendIsTheSoftmaxAverage) {
  Random random(4);
  const std::int64_t capacity = 300, heads = 2, sequences = 2;
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8})
    for (const std::int64_t width : {1, 7, 16, 33, 48, 64, 100}) {
      Arena arena;
      KeyValueCache cache(sequences, heads, capacity, width, precision, arena);
      std::vector<float> scratch(static_cast<std::size_t>(cache.scratch_size())),
          out(static_cast<std::size_t>(width));
      for (int again = 0; again < 2; ++again)  // the second time over what the first left
        for (std::int64_t pair = 0; pair < sequences * heads; ++pair) {
          const auto keys = normal_numbers(random, capacity * width, 0, 1.5),
                     values = normal_numbers(random, capacity * width),
                     query = normal_numbers(random, width, 0, 1.5);
          for (std::int64_t t = 0; t < capacity; ++t) {
            cache.store(pair / heads, pair % heads, t, keys.data() + t * width,
                        values.data() + t * width);
            const std::int64_t count = t + 1;
            if (count > 35 && count % 97 != 0 && count != capacity) continue;
            cache.attend(pair / heads, pair % heads, count, query.data(), scratch.data(),
                         out.data());
            const auto expected = softmax_average(query.data(), keys, values, count, width);
            for (std::size_t i = 0; i < out.size(); ++i)
              ASSERT_NEAR(out[i], expected[i],
                          precision == Precision::f32    ? 1e-4
                          : precision == Precision::bf16 ? 0.06
                                                         : 0.1)
                  << to_string(precision) << ", width " << width << ", " << count << " positions";
          }
        }
    }
}

TEST_P(Cache, LargeScoresDoNotOverflow) {
  Arena arena;
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
    KeyValueCache cache(1, 1, 20, 16, precision, arena);
    std::vector<float> scratch(static_cast<std::size_t>(cache.scratch_size())), out(16);
    const std::vector<float> big(16, 200.f), small(16, -200.f);
    for (std::int64_t t = 0; t < 20; ++t)
      cache.store(0, 0, t, (t == 7 ? big : small).data(), (t == 7 ? small : big).data());
    cache.attend(0, 0, 20, big.data(), scratch.data(), out.data());
    for (const float value : out) EXPECT_NEAR(value, -200, 1e-4);
  }
}

}  // namespace

}  // namespace mocaplm::cache_test
