// Settings of infilling.
#pragma once

#include <cstdint>

#include "common/settings.h"

namespace mocaplm {

struct FillOptions {
  std::int64_t rounds = 16;
  double temperature = 0;  // 0: the likeliest bin
  std::int64_t seed = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("rounds", rounds, 1, 10000,
              "times that the model looks; each time it keeps what it is surest of");
    v.number("temperature", temperature, 0, 100, "0 takes the likeliest bin, 1 draws as told");
    v.integer("seed", seed, 0, 2147483647, "seed of the draws");
  }
};

}  // namespace mocaplm
