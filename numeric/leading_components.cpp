#include "numeric/leading_components.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cassert>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm {

namespace {

constexpr Eigen::Index kOversampling = 10;
constexpr int kIterations = 4;

// Orthonormal columns that span the same space; directions that are missing are made up.
Eigen::MatrixXf orthonormal(const Eigen::MatrixXf& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXf> qr(columns);
  return qr.householderQ() * Eigen::MatrixXf::Identity(columns.rows(), columns.cols());
}

}  // namespace

LeadingComponents leading_components(const Eigen::Ref<const Eigen::MatrixXf>& x, Eigen::Index k,
                                     std::uint64_t seed, bool centre) {
  assert(x.rows() >= 1 && k >= 1 && k <= x.cols());
  if (!x.allFinite())
    throw DataError(in_file("component analysis"), "the values are not all finite");
  LeadingComponents found;
  found.mean = centre ? x.colwise().mean().eval() : Eigen::RowVectorXf::Zero(x.cols()).eval();
  const Eigen::MatrixXf centred = x.rowwise() - found.mean;
  const Eigen::Index width = std::min(k + kOversampling, x.cols());
  Random random(seed);
  Eigen::MatrixXf basis(x.cols(), width);
  for (Eigen::Index i = 0; i < basis.size(); ++i)
    basis.data()[i] = static_cast<float>(random.normal());
  basis = orthonormal(basis);
  Eigen::MatrixXf scores(x.rows(), width);
  for (int i = 0; i < kIterations; ++i) {
    scores.noalias() = centred * basis;
    basis = orthonormal(centred.transpose() * scores);
  }
  scores.noalias() = centred * basis;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      (scores.transpose() * scores).cast<double>());
  const Eigen::MatrixXf turn = eigen.eigenvectors().rowwise().reverse().cast<float>();
  found.basis = basis * turn.leftCols(k);
  for (Eigen::Index c = 0; c < k; ++c) {  // one sign everywhere
    Eigen::Index largest = 0;
    found.basis.col(c).cwiseAbs().maxCoeff(&largest);
    if (found.basis(largest, c) < 0) found.basis.col(c) *= -1;
  }
  return found;
}

}  // namespace mocaplm
