// Whether samples come from one distribution, judged from the distances between their members
// alone: energy distance and DISCO (Rizzo and Szekely 2010, "DISCO analysis", Annals of Applied
// Statistics 4(2), 1034-1055), with p-values by permutation.
//
// With distances d raised to alpha, N members in K samples of n_k, and g(A, B) their mean d:
//   total  T = N / 2 g(all, all)        within W = sum_k n_k / 2 g(A_k, A_k)
//   F = ((T - W) / (K - 1)) / (W / (N - K))
//   K = 2:  e = 2 g(A, B) - g(A, A) - g(B, B),  T - W = n_A n_B / (2 N) e
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mocaplm {

struct EnergyOptions {
  double alpha = 1;  // power of the distances, in (0, 2]; with 2 only means are compared
  std::int64_t permutations = 999;  // 1 or more
  std::uint64_t seed = 1;
};

struct EnergyTest {
  double statistic = 0;  // e for two samples, T - W for more
  double ratio = 0;      // DISCO's F; infinite when W is 0 and T is not
  double within = 0;     // W
  double p = 1;          // (1 + permutations with W no larger) / (1 + permutations)
};

// The first `first` rows of the distances (N, N) are one sample, the rest the other. Throws
// UsageError for options outside their range, DataError when a sample is empty or the matrix is not
// square, symmetric, finite and nowhere negative, with a diagonal of zeros.
EnergyTest energy_test(const Eigen::MatrixXd& distance, Eigen::Index first,
                       const EnergyOptions& options = {});
// The same for K >= 2 samples: member i belongs to sample groups[i], in 0 .. K-1, none empty.
EnergyTest disco_test(const Eigen::MatrixXd& distance, const std::vector<int>& groups,
                      const EnergyOptions& options = {});

}  // namespace mocaplm
