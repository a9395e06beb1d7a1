// Rows of embedding tables.
#pragma once

#include <cstdint>
#include <vector>

namespace mocaplm {

inline void add_row(float* to, const std::vector<float>& table, std::int64_t row,
                    std::int64_t width) {
  const float* from = table.data() + row * width;
  for (std::int64_t i = 0; i < width; ++i) to[i] += from[i];
}

}  // namespace mocaplm
