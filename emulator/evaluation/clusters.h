// Canonical postures, and sequences said in them (section 4.4, 3: shape quantization).
#pragma once

#include <cstdint>
#include <vector>

#include "emulator/sequence.h"
#include "numeric/modes.h"
#include "numeric/symbols.h"

namespace mocaplm {

struct PostureClusters {
  PostureSequence canonical;       // (3 L, K): the mean posture of each cluster
  std::vector<std::size_t> sizes;  // (K): of the sample
  std::vector<ModeTrial> trials;   // what was tried to find the number of clusters
  std::size_t postures = 0;        // looked at
  int count() const { return static_cast<int>(canonical.frames()); }
};

// Mode-based clustering (numeric/modes.h) of at most `postures` frames drawn from all sequences,
// with the posture distance of equation 1. The number of clusters comes from the data unless
// `clusters` says it. Throws DataError for no frames.
PostureClusters find_posture_clusters(const std::vector<const PostureSequence*>& sequences,
                                      std::size_t postures, int clusters, std::uint64_t seed,
                                      int threads = 0);

// B(t): the canonical posture nearest to each frame.
Symbols quantise(const PostureSequence& sequence, const PostureClusters& clusters);
std::vector<Symbols> quantise_all(const std::vector<PostureSequence>& sequences,
                                  const PostureClusters& clusters, int threads = 0);

}  // namespace mocaplm
