// Vectors of random numbers.
#pragma once

#include <vector>

#include "common/random.h"

namespace mocaplm {

inline std::vector<float> normal_numbers(Random& random, std::int64_t count, double mean = 0,
                                         double deviation = 1) {
  std::vector<float> values;
  for (std::int64_t i = 0; i < count; ++i)
    values.push_back(static_cast<float>(mean + deviation * random.normal()));
  return values;
}

}  // namespace mocaplm
