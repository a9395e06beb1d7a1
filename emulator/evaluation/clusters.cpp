#include "emulator/evaluation/clusters.h"

#include <algorithm>
#include <utility>

#include "common/error.h"
#include "common/parallel.h"
#include "common/random.h"
#include "emulator/distances.h"

namespace mocaplm {

namespace {

using Eigen::Index;

// Frames drawn without repetition, in the order of the sequences.
PostureSequence draw_frames(const std::vector<const PostureSequence*>& sequences, std::size_t count,
                            std::uint64_t seed) {
  std::vector<std::pair<std::size_t, Index>> frames;
  for (std::size_t i = 0; i < sequences.size(); ++i)
    for (Index t = 0; t < sequences[i]->frames(); ++t) frames.emplace_back(i, t);
  if (frames.empty()) throw DataError(in_file("posture clusters"), "there are no postures");
  if (frames.size() > count) {
    Random(seed).shuffle(frames);
    frames.resize(count);
    std::sort(frames.begin(), frames.end());
  }
  PostureSequence drawn;
  drawn.values.resize(sequences[0]->values.rows(), static_cast<Index>(frames.size()));
  for (std::size_t k = 0; k < frames.size(); ++k)
    drawn.values.col(static_cast<Index>(k)) =
        sequences[frames[k].first]->values.col(frames[k].second);
  return drawn;
}

PostureSequence members(const PostureSequence& all, const std::vector<int>& cluster, int k) {
  PostureSequence chosen;
  chosen.values.resize(all.values.rows(), std::count(cluster.begin(), cluster.end(), k));
  Index to = 0;
  for (Index t = 0; t < all.frames(); ++t)
    if (cluster[static_cast<std::size_t>(t)] == k) chosen.values.col(to++) = all.values.col(t);
  return chosen;
}

}  // namespace

PostureClusters find_posture_clusters(const std::vector<const PostureSequence*>& sequences,
                                      std::size_t postures, int clusters, std::uint64_t seed,
                                      int threads) {
  const PostureSequence sample = draw_frames(sequences, postures, seed);
  ModeOptions options;
  options.count = clusters;
  const Modes modes =
      find_modes(posture_distances(PackedPostures::of_frames({sample}), threads), options);
  PostureClusters result;
  result.postures = static_cast<std::size_t>(sample.frames());
  result.trials = modes.trials;
  result.canonical.values.resize(sample.values.rows(), static_cast<Index>(modes.modes.size()));
  result.sizes.resize(modes.modes.size());
  parallel_for(modes.modes.size(), threads, [&](std::size_t k) {
    const PostureSequence own = members(sample, modes.cluster, static_cast<int>(k));
    result.sizes[k] = static_cast<std::size_t>(own.frames());
    result.canonical.at(static_cast<Index>(k)) = mean_posture({own}, 500);
  });
  return result;
}

Symbols quantise(const PostureSequence& sequence, const PostureClusters& clusters) {
  const Eigen::MatrixXd d = cross_distances(PackedPostures::of_frames({sequence}),
                                            PackedPostures::of_frames({clusters.canonical}), 1);
  Symbols symbols(static_cast<std::size_t>(d.rows()));
  for (Index t = 0; t < d.rows(); ++t) {
    Index nearest = 0;
    d.row(t).minCoeff(&nearest);
    symbols[static_cast<std::size_t>(t)] = static_cast<int>(nearest);
  }
  return symbols;
}

std::vector<Symbols> quantise_all(const std::vector<PostureSequence>& sequences,
                                  const PostureClusters& clusters, int threads) {
  std::vector<Symbols> all(sequences.size());
  parallel_for(sequences.size(), threads,
               [&](std::size_t i) { all[i] = quantise(sequences[i], clusters); });
  return all;
}

}  // namespace mocaplm
