// The first few principal components of many dimensions, where all of them would take minutes.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mocaplm {

struct LeadingComponents {
  Eigen::RowVectorXf mean;  // (d)
  Eigen::MatrixXf basis;    // (d, k) orthonormal columns, by falling variance
};

// Randomised subspace iteration (Halko, Martinsson and Tropp 2011, algorithms 4.4 and 5.1) on the
// centred x (n, d); k <= d. Beyond the rank of x the columns are any that are orthonormal to the
// others. Not centred, the mean is 0 and the columns span what x itself fills. Throws DataError
// when x holds values that are not finite.
LeadingComponents leading_components(const Eigen::Ref<const Eigen::MatrixXf>& x, Eigen::Index k,
                                     std::uint64_t seed = 1, bool centred = true);

}  // namespace mocaplm
