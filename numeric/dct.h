// The discrete cosine transform, orthonormal, and a lapped form of it. A transform is a matrix
// whose rows are its basis: coefficients = matrix * samples, samples = matrix^T * coefficients.
// Blocks are short here (a second of motion), so a product is as quick as a fast transform.
#pragma once

#include <Eigen/Core>

namespace mocaplm {

// DCT-II of n samples (its transpose is the DCT-III): row k is s_k cos(pi (t + 1/2) k / n) with s_0
// = sqrt(1/n) and s_k = sqrt(2/n).
Eigen::MatrixXd dct_matrix(Eigen::Index n);
// Rows [first, first + count) of it, where all of them would be too many: in time and memory of
// what is asked for.
Eigen::MatrixXd dct_rows(Eigen::Index n, Eigen::Index first, Eigen::Index count);
// DCT-IV, its own inverse: sqrt(2/n) cos(pi (t + 1/2)(k + 1/2) / n).
Eigen::MatrixXd dct4_matrix(Eigen::Index n);

// What makes block transforms overlap: an orthogonal filter over the samples around each border
// between two blocks, before the blocks are transformed; its transpose, after they are transformed
// back, smooths the border. With the DCT-II behind it this is the lapped orthogonal transform
// (Malvar 1992; Tran, Liang and Tu 2003, "Lapped transform via time-domain pre- and
// post-filtering", V = J C_II^T C_IV J). The signal's ends have no border and stay as they are, so
// there are as many coefficients as samples, and a constant stays constant.
class LapFilter {
 public:
  // Blocks of n samples; n / 2 samples (rounded down) on each side of a border are mixed.
  explicit LapFilter(Eigen::Index n);
  Eigen::Index block() const { return block_; }
  // In place on (time, channels), a whole number of blocks; undo is the exact inverse.
  void apply(Eigen::Ref<Eigen::MatrixXd> signal) const { run(signal, odd_); }
  void undo(Eigen::Ref<Eigen::MatrixXd> signal) const { run(signal, odd_.transpose()); }

 private:
  void run(Eigen::Ref<Eigen::MatrixXd> signal, const Eigen::MatrixXd& odd) const;

  Eigen::Index block_;
  Eigen::MatrixXd odd_;  // (n / 2, n / 2): V, on the difference of both sides
};

}  // namespace mocaplm
