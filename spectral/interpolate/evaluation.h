// What interpolation does to pairs of recordings, for each kind of features (thesis Tables 3.3 and
// 3.4), and how smooth the motions are that come out.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/table.h"
#include "motion/dataset.h"
#include "spectral/interpolate/config.h"

namespace mocaplm {

struct InterpolateEvaluation {
  std::filesystem::path dataset;
  std::string label;  // what the clips of a pair differ in
  InterpolatePairs pairs;
  InterpolateConfig config;  // its target is not looked at
};

// Entries (A, B) of the dataset. Its clips of the split that have the label and last 2 s are
// shuffled; each one that is still free is paired with the next free one of another value. Fewer
// than asked for where the clips do not suffice. Throws UsageError for a label that no clip has,
// DataError where there is no pair.
std::vector<std::pair<std::size_t, std::size_t>> different_pairs(const Dataset& dataset,
                                                                 const std::string& label,
                                                                 const InterpolatePairs& config);

// Three tables: over all pairs, for each kind of features, similarities (of STFTs) and roughness;
// similarities of each pair; roughness of each pair. Kinds: dct and stft within the config's range
// of frequencies and with all frequencies, pca, own_pca. All frequencies of the DCT end at the
// frame-by-frame mean of both motions. Throws as different_pairs and interpolate do.
std::vector<Table> evaluate_interpolate(const InterpolateEvaluation& options);

}  // namespace mocaplm
