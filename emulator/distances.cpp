#include "emulator/distances.h"

#include <cassert>
#include <cmath>
#include <string>

#include "common/error.h"
#include "common/parallel.h"
#include "emulator/angles.h"

namespace mocaplm {

namespace {

using Eigen::Index;

[[noreturn]] void refuse(const std::string& what) {
  throw DataError(in_file("posture distances"), what);
}

AngleSum kernel() {
  return angle_kernels().back().sum;
}

// Pairs (i, j < i) of a square matrix, in tasks of several rows from both ends, so that all are of
// like size.
template <class Scalar>
Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> all_pairs(const PackedPostures& rows,
                                                                int threads) {
  const Index n = rows.count();
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> d(n, n);
  const AngleSum sum = kernel();
  const double scale = 1 / static_cast<double>(rows.frames());
  const auto fill_row = [&](Index i) {
    d(i, i) = 0;
    for (Index j = 0; j < i; ++j)
      d(j, i) = static_cast<Scalar>(scale * sum(rows.row(i), rows.row(j), rows.blocks()));
  };
  parallel_for(static_cast<std::size_t>((n + 1) / 2), threads, [&](std::size_t task) {
    const auto low = static_cast<Index>(task), high = n - 1 - low;
    fill_row(high);
    if (low != high) fill_row(low);
  });
  // The other half, in tiles that stay in the cache.
  constexpr Index kTile = 64;
  parallel_for(static_cast<std::size_t>((n + kTile - 1) / kTile), threads, [&](std::size_t task) {
    const Index from = static_cast<Index>(task) * kTile, to = std::min(n, from + kTile);
    for (Index begin = from; begin < n; begin += kTile)
      for (Index j = from; j < to; ++j)
        for (Index i = std::max(begin, j + 1); i < std::min(n, begin + kTile); ++i)
          d(i, j) = d(j, i);
  });
  return d;
}

}  // namespace

void PackedPostures::reserve(Index count, Index frames, Index limbs) {
  count_ = count;
  frames_ = frames;
  limbs_ = limbs;
  blocks_ = (frames * limbs + kAngleLanes - 1) / kAngleLanes;
  values_.assign(static_cast<std::size_t>(count * blocks_ * kAngleBlock), 0);
}

void PackedPostures::put(Index row, const double* directions) {
  double* to = values_.data() + row * blocks_ * kAngleBlock;
  for (Index i = 0; i < blocks_ * kAngleLanes; ++i) {
    double* block = to + i / kAngleLanes * kAngleBlock + i % kAngleLanes;
    const bool is_vector = i < frames_ * limbs_;
    // The rest of the last block is the same vector everywhere: no angle.
    for (Index axis = 0; axis < 3; ++axis)
      block[axis * kAngleLanes] = is_vector ? directions[3 * i + axis] : (axis == 0 ? 1 : 0);
  }
}

PackedPostures::PackedPostures(const std::vector<PostureSequence>& sequences) {
  if (sequences.empty()) return;
  const PostureSequence& first = sequences[0];
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    const PostureSequence& s = sequences[i];
    const std::string name = "sequence " + std::to_string(i + 1);
    if (s.frames() != first.frames() || s.limbs() != first.limbs() || s.frames() < 1)
      refuse(name + " has " + std::to_string(s.frames()) + " frames of " +
             std::to_string(s.limbs()) + " limbs, the first " + std::to_string(first.frames()) +
             " of " + std::to_string(first.limbs()));
    if (!s.values.allFinite()) refuse(name + " holds values that are not finite");
  }
  reserve(static_cast<Index>(sequences.size()), first.frames(), first.limbs());
  for (std::size_t i = 0; i < sequences.size(); ++i)
    put(static_cast<Index>(i), sequences[i].values.data());
}

PackedPostures PackedPostures::of_frames(const std::vector<PostureSequence>& sequences) {
  PackedPostures packed;
  Index frames = 0;
  for (const PostureSequence& s : sequences) {
    if (s.limbs() != sequences[0].limbs()) refuse("the sequences have not the same limbs");
    if (!s.values.allFinite()) refuse("a posture holds values that are not finite");
    frames += s.frames();
  }
  if (frames == 0) return packed;
  packed.reserve(frames, 1, sequences[0].limbs());
  Index row = 0;
  for (const PostureSequence& s : sequences)
    for (Index t = 0; t < s.frames(); ++t) packed.put(row++, s.values.col(t).data());
  return packed;
}

Eigen::MatrixXd sequence_distances(const PackedPostures& rows, int threads) {
  return all_pairs<double>(rows, threads);
}

Eigen::MatrixXd sequence_distances(const std::vector<PostureSequence>& sequences, int threads) {
  return sequence_distances(PackedPostures(sequences), threads);
}

Eigen::MatrixXf posture_distances(const PackedPostures& rows, int threads) {
  return all_pairs<float>(rows, threads);
}

Eigen::MatrixXd cross_distances(const PackedPostures& a, const PackedPostures& b, int threads) {
  if (a.count() > 0 && b.count() > 0 && (a.frames() != b.frames() || a.blocks() != b.blocks()))
    refuse("the two lists have not the same frames and limbs");
  Eigen::MatrixXd d(a.count(), b.count());
  const AngleSum sum = kernel();
  parallel_for(static_cast<std::size_t>(a.count()), threads, [&](std::size_t task) {
    const auto i = static_cast<Index>(task);
    for (Index j = 0; j < b.count(); ++j)
      d(i, j) = sum(a.row(i), b.row(j), a.blocks()) / static_cast<double>(a.frames());
  });
  return d;
}

Eigen::MatrixXd cross_distances(const std::vector<PostureSequence>& a,
                                const std::vector<PostureSequence>& b, int threads) {
  return cross_distances(PackedPostures(a), PackedPostures(b), threads);
}

Eigen::VectorXd steps_of(const PostureSequence& sequence) {
  const PackedPostures frames = PackedPostures::of_frames({sequence});
  Eigen::VectorXd steps(std::max<Index>(0, frames.count() - 1));
  for (Index t = 0; t < steps.size(); ++t)
    steps[t] = kernel()(frames.row(t), frames.row(t + 1), frames.blocks());
  return steps;
}

Eigen::VectorXd mean_steps(const std::vector<PostureSequence>& sequences) {
  assert(!sequences.empty());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(std::max<Index>(0, sequences[0].frames() - 1));
  for (const PostureSequence& sequence : sequences)
    mean += steps_of(sequence) / static_cast<double>(sequences.size());
  return mean;
}

}  // namespace mocaplm
