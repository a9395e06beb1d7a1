#include "numeric/symbols.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace mocaplm {

double disagreement(const Symbols& a, const Symbols& b) {
  assert(a.size() == b.size() && !a.empty());
  std::size_t differ = 0;
  for (std::size_t t = 0; t < a.size(); ++t) differ += a[t] != b[t];
  return static_cast<double>(differ) / static_cast<double>(a.size());
}

Variability variability(const std::vector<Symbols>& sequences, const Symbols& reference) {
  assert(!sequences.empty());
  const auto n = static_cast<double>(sequences.size());
  std::vector<double> all;
  Variability result;
  for (const Symbols& sequence : sequences) {
    all.push_back(disagreement(sequence, reference));
    result.mean += all.back() / n;
  }
  for (const double e : all)
    result.variance += (e - result.mean) * (e - result.mean) / std::max(1.0, n - 1);
  return result;
}

std::vector<Eigen::MatrixXd> transition_matrices(const std::vector<Symbols>& sequences, int k,
                                                 int length, int step) {
  assert(!sequences.empty() && k >= 1 && length >= 1 && step >= 1);
  const int steps = static_cast<int>(sequences[0].size()) - 1;
  if (steps < 1) return {};
  length = std::min(length, steps);
  std::vector<Eigen::MatrixXd> matrices;
  for (int begin = 0; begin + length <= steps; begin += step) {
    Eigen::MatrixXd counts = Eigen::MatrixXd::Zero(k, k);
    for (const Symbols& sequence : sequences) {
      assert(static_cast<int>(sequence.size()) == steps + 1);
      for (int t = begin; t < begin + length; ++t) {
        const auto at = static_cast<std::size_t>(t);
        counts(sequence[at], sequence[at + 1]) += 1;
      }
    }
    for (int i = 0; i < k; ++i) {
      const double visits = counts.row(i).sum();
      if (visits > 0) counts.row(i) /= visits;
    }
    matrices.push_back(std::move(counts));
  }
  return matrices;
}

std::vector<Eigen::MatrixXd> uniform_transitions(std::size_t windows, int k) {
  return std::vector<Eigen::MatrixXd>(windows, Eigen::MatrixXd::Constant(k, k, 1.0 / k));
}

double transition_difference(const std::vector<Eigen::MatrixXd>& p,
                             const std::vector<Eigen::MatrixXd>& q) {
  assert(p.size() == q.size());
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += (p[i] - q[i]).cwiseAbs().sum();
  return sum;
}

}  // namespace mocaplm
