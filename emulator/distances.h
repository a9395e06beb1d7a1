// Distances of many posture sequences to each other (equations 1 and 4), fast.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "emulator/sequence.h"

namespace mocaplm {

// Rows of postures, as emulator/angles.h wants them.
class PackedPostures {
 public:
  // Each sequence is a row: all have the same limbs and frames. Throws DataError otherwise, or when
  // a value is not finite, naming the sequence.
  explicit PackedPostures(const std::vector<PostureSequence>& sequences);
  // Each frame of these sequences is a row (limbs alike, lengths may differ).
  static PackedPostures of_frames(const std::vector<PostureSequence>& sequences);

  Eigen::Index count() const { return count_; }
  const double* row(Eigen::Index i) const { return values_.data() + i * blocks_ * 24; }
  Eigen::Index blocks() const { return blocks_; }
  Eigen::Index frames() const { return frames_; }  // of a row

 private:
  PackedPostures() = default;
  void reserve(Eigen::Index count, Eigen::Index frames, Eigen::Index limbs);
  void put(Eigen::Index row, const double* directions);  // frames * limbs vectors, x y z each

  Eigen::Index count_ = 0, frames_ = 0, limbs_ = 0, blocks_ = 0;
  std::vector<double> values_;
};

// Mean over frames of the sum of angles. (n, n), symmetric, zero on the diagonal.
Eigen::MatrixXd sequence_distances(const PackedPostures& rows, int threads = 0);
Eigen::MatrixXd sequence_distances(const std::vector<PostureSequence>& sequences, int threads = 0);
// (n, m). Throws DataError when limbs or frames differ.
Eigen::MatrixXd cross_distances(const PackedPostures& a, const PackedPostures& b, int threads = 0);
Eigen::MatrixXd cross_distances(const std::vector<PostureSequence>& a,
                                const std::vector<PostureSequence>& b, int threads = 0);
// The first matrix in single precision, for thousands of postures.
Eigen::MatrixXf posture_distances(const PackedPostures& rows, int threads = 0);

// d(a(t), a(t + 1)) for each t: how far a motion goes from frame to frame (section 5.2, its
// roughness). (T - 1).
Eigen::VectorXd steps_of(const PostureSequence& sequence);
// The mean of steps_of over sequences of one length.
Eigen::VectorXd mean_steps(const std::vector<PostureSequence>& sequences);

}  // namespace mocaplm
