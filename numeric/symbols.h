// Sequences of symbols 0 .. k-1, all of one length T: how far they agree, and how one symbol
// follows another (Chen, Park and Srivastava, "Statistical Emulation of Human Operational
// Motions", 4.4).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mocaplm {

using Symbols = std::vector<int>;

// The share of places where they differ: E = 1/T sum_t [a(t) != b(t)].
double disagreement(const Symbols& a, const Symbols& b);

struct Variability {
  double mean = 0;      // of E over the sequences
  double variance = 0;  // with n - 1; 0 for one sequence
};
// Of one sequence or more, against a reference.
Variability variability(const std::vector<Symbols>& sequences, const Symbols& reference);

// One (k, k) matrix a window of `length` steps, which begin at 0, step, 2 step, ... and lie inside
// the sequences: how often symbol i was followed by j in any sequence, by how often it was there.
// A row whose symbol never comes is zero. Length and step are 1 or more; sequences shorter than a
// window give one window of all of their steps, of a single symbol none.
std::vector<Eigen::MatrixXd> transition_matrices(const std::vector<Symbols>& sequences, int k,
                                                 int length, int step);
// As many matrices whose entries are all 1 / k: a walk at random.
std::vector<Eigen::MatrixXd> uniform_transitions(std::size_t windows, int k);
// Sum over all windows and entries of |p - q| (the paper's L1 norm).
double transition_difference(const std::vector<Eigen::MatrixXd>& p,
                             const std::vector<Eigen::MatrixXd>& q);

}  // namespace mocaplm
