// Points in a plane (or in k dimensions) whose distances come near given ones: classical
// multidimensional scaling (Torgerson 1952). With J = I - 1 1' / n the eigenvectors of
//   B = -1/2 J D^2 J
// of largest eigenvalues l are the axes, each scaled by sqrt(l).
#pragma once

#include <Eigen/Core>

namespace mocaplm {

struct Scaling {
  Eigen::MatrixXd points;       // (n, k), centred; axes by falling eigenvalue
  Eigen::VectorXd eigenvalues;  // (n) falling; negative ones tell that no space has these distances
  // What the k axes hold of the sum of the positive eigenvalues, in [0, 1].
  double share = 0;
};

// distance (n, n), 1 <= k <= n. An axis without a positive eigenvalue is all zeros. The largest
// entry of an axis is positive. Throws DataError when the matrix is not square and finite.
Scaling classical_scaling(const Eigen::MatrixXd& distance, Eigen::Index k);

}  // namespace mocaplm
