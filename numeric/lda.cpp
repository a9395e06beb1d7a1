#include "numeric/lda.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>
#include <limits>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

void check(const Eigen::MatrixXd& x, double shrinkage) {
  if (!(shrinkage >= 0 && shrinkage <= 1))
    throw UsageError("LDA's shrinkage is " + format_number(shrinkage) + ", expected 0 to 1");
  if (x.rows() == 0 || x.cols() == 0)
    throw DataError(in_file("LDA"), "there is nothing to learn from: no samples");
  if (!x.allFinite())
    throw DataError(in_file("LDA"), "the samples hold numbers that are not finite");
}

// C^-1 B. Without shrinkage C may be singular: directions of (relatively) no variance are dropped.
Eigen::MatrixXd solve(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& b,
                      bool may_be_singular) {
  if (!may_be_singular) return covariance.ldlt().solve(b);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  const double least = 1e-10 * eigen.eigenvalues().maxCoeff();
  const Eigen::VectorXd inverse = eigen.eigenvalues().unaryExpr(
      [least](double value) { return value > least ? 1 / value : 0.0; });
  return eigen.eigenvectors() * (inverse.asDiagonal() * (eigen.eigenvectors().transpose() * b));
}

}  // namespace

Lda Lda::fit(const Eigen::MatrixXd& x, const std::vector<int>& classes, int n_classes,
             double shrinkage) {
  check(x, shrinkage);
  assert(static_cast<Eigen::Index>(classes.size()) == x.rows());
  const Eigen::Index n = x.rows(), d = x.cols();
  Lda lda;
  lda.centre_ = x.colwise().mean();
  Eigen::MatrixXd centred = x.rowwise() - lda.centre_;
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(d, n_classes);
  Eigen::RowVectorXd counts = Eigen::RowVectorXd::Zero(n_classes);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int k = classes[static_cast<std::size_t>(i)];
    assert(k >= 0 && k < n_classes);
    means.col(k) += centred.row(i).transpose();
    counts[k] += 1;
  }
  for (int k = 0; k < n_classes; ++k)
    if (counts[k] > 0) means.col(k) /= counts[k];
  for (Eigen::Index i = 0; i < n; ++i)
    centred.row(i) -= means.col(classes[static_cast<std::size_t>(i)]).transpose();

  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(d, d);
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(centred.transpose(),
                                                        1 / static_cast<double>(n));
  covariance = Eigen::MatrixXd(covariance.selfadjointView<Eigen::Lower>());
  const double variance = covariance.trace() / static_cast<double>(d);
  if (!(variance > 0) || !std::isfinite(variance))
    throw DataError(in_file("LDA"),
                    "the samples of each class are all the same; it needs some that vary");
  covariance *= 1 - shrinkage;
  covariance.diagonal().array() += shrinkage * variance;

  lda.weights_ = solve(covariance, means, shrinkage == 0);
  lda.offsets_ = -0.5 * (means.array() * lda.weights_.array()).colwise().sum();
  for (int k = 0; k < n_classes; ++k)
    lda.offsets_[k] += counts[k] > 0 ? std::log(counts[k] / static_cast<double>(n))
                                     : -std::numeric_limits<double>::infinity();
  return lda;
}

Eigen::MatrixXd Lda::scores(const Eigen::MatrixXd& x) const {
  assert(x.cols() == weights_.rows());
  return ((x.rowwise() - centre_) * weights_).rowwise() + offsets_;
}

std::vector<int> Lda::predict(const Eigen::MatrixXd& x) const {
  const Eigen::MatrixXd all = scores(x);
  std::vector<int> best(static_cast<std::size_t>(all.rows()));
  for (Eigen::Index i = 0; i < all.rows(); ++i) {
    Eigen::Index k = 0;
    all.row(i).maxCoeff(&k);
    best[static_cast<std::size_t>(i)] = static_cast<int>(k);
  }
  return best;
}

}  // namespace mocaplm
