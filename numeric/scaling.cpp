#include "numeric/scaling.h"

#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>

#include "common/error.h"

namespace mocaplm {

Scaling classical_scaling(const Eigen::MatrixXd& distance, Eigen::Index k) {
  const Eigen::Index n = distance.rows();
  assert(k >= 1 && k <= n);
  if (distance.cols() != n || !distance.allFinite())
    throw DataError(in_file("multidimensional scaling"),
                    "the distances are not a square matrix of finite numbers");
  Eigen::MatrixXd b = distance.cwiseAbs2() * -0.5;
  const Eigen::RowVectorXd column_means = b.colwise().mean();
  const Eigen::VectorXd row_means = b.rowwise().mean();
  const double mean = row_means.mean();
  b.rowwise() -= column_means;
  b.colwise() -= row_means;
  b.array() += mean;

  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(b);
  Scaling scaling;
  scaling.eigenvalues = eigen.eigenvalues().reverse();
  scaling.points = Eigen::MatrixXd::Zero(n, k);
  const double all = scaling.eigenvalues.cwiseMax(0).sum();
  for (Eigen::Index i = 0; i < k; ++i) {
    const double value = scaling.eigenvalues[i];
    if (!(value > 1e-12 * all)) break;
    Eigen::VectorXd axis = eigen.eigenvectors().col(n - 1 - i) * std::sqrt(value);
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    scaling.points.col(i) = axis[largest] < 0 ? -axis : axis;
    scaling.share += value / all;
  }
  return scaling;
}

}  // namespace mocaplm
