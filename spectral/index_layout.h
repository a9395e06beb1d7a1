// Where things lie in an index's file, for who writes it and who reads it (spectral/index.h).
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "spectral/config.h"

namespace mocaplm {

constexpr char kIndexMagic[32] = "mocaplm spectral index 2\n";
constexpr std::size_t kIndexHead = 32;    // two u64: where the JSON begins, its bytes
constexpr std::size_t kIndexRows = 4096;  // where the rows begin

struct IndexLayout {
  // Bytes from the file's beginning.
  std::size_t sketch = 0, coarse = 0, lengths = 0, windows = 0, learned = 0, json = 0;
  Eigen::Index time_frames = 0, time_components = 0, reduce_from = 0;  // shapes
};

// Coordinates of the sketches of rows of d dimensions, 0 for none.
Eigen::Index sketch_size(Eigen::Index d);

IndexLayout index_layout(const SpectralConfig& config, Eigen::Index raw, Eigen::Index n,
                         Eigen::Index d, Eigen::Index s);

}  // namespace mocaplm
