// A linear change of coordinates that keeps fewer of them: principal and independent components.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mocaplm {

struct Components {
  Eigen::RowVectorXd mean;    // (d)
  Eigen::MatrixXd analysis;   // (d, k): (x - mean) * analysis are the components
  Eigen::MatrixXd synthesis;  // (k, d): components * synthesis + mean is nearest to x

  Eigen::Index dimensions() const { return analysis.rows(); }
  Eigen::Index count() const { return analysis.cols(); }
  // x (n, d) to (n, k), and back.
  Eigen::MatrixXd project(const Eigen::MatrixXd& x) const {
    return (x.rowwise() - mean) * analysis;
  }
  Eigen::MatrixXd restore(const Eigen::MatrixXd& components) const {
    return (components * synthesis).rowwise() + mean;
  }
};

// Principal components (Pearson 1901), the k of largest variance, that first: analysis has
// orthonormal columns, each with its largest entry positive. x (n, d) with n >= 1, 1 <= k <= d.
// Throws DataError when x holds values that are not finite.
Components principal_components(const Eigen::MatrixXd& x, Eigen::Index k);

struct IcaReport {
  int iterations = 0;
  bool converged = false;
};

// Independent components by FastICA (Hyvarinen 1999; symmetric, tanh) inside the k principal
// components, which are whitened first; those whose variance is below 1e-12 of the largest are
// left out, so that there may be fewer than k. Each component is scaled to the length that it has
// in x (rows of synthesis are of unit length) and they are ordered by variance. The same seed gives
// the same components.
Components independent_components(const Eigen::MatrixXd& x, Eigen::Index k, std::uint64_t seed = 1,
                                  IcaReport* report = nullptr);

}  // namespace mocaplm
