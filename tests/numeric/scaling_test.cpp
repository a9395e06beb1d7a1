#include "numeric/scaling.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm::scaling_test {
namespace {

Eigen::MatrixXd distances(const Eigen::MatrixXd& x) {
  Eigen::MatrixXd d(x.rows(), x.rows());
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (Eigen::Index j = 0; j < x.rows(); ++j) d(i, j) = (x.row(i) - x.row(j)).norm();
  return d;
}

Eigen::MatrixXd points(Eigen::Index n, Eigen::Index k, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd x(n, k);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.normal();
  return x;
}

TEST(ClassicalScaling, FindsPointsOfAPlane) {
  const Eigen::MatrixXd d = distances(points(20, 2, 1));
  const Scaling scaling = classical_scaling(d, 2);
  EXPECT_LT((distances(scaling.points) - d).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(scaling.share, 1, 1e-9);
  EXPECT_LT(scaling.points.colwise().mean().norm(), 1e-9);
  // A third axis has nothing left.
  EXPECT_LT(classical_scaling(d, 3).points.col(2).norm(), 1e-4);
}

// Of points in space the axes are the principal components.
TEST(ClassicalScaling, AxesArePrincipalComponents) {
  const Eigen::MatrixXd x = points(30, 5, 2);
  const Eigen::MatrixXd centred = x.rowwise() - x.colwise().mean();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeThinU);
  const Scaling scaling = classical_scaling(distances(x), 3);
  for (Eigen::Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(scaling.eigenvalues[k], std::pow(svd.singularValues()[k], 2), 1e-8);
    EXPECT_NEAR(std::abs(scaling.points.col(k).dot(svd.matrixU().col(k))), svd.singularValues()[k],
                1e-8);
  }
  EXPECT_NEAR(scaling.share,
              svd.singularValues().head(3).squaredNorm() / svd.singularValues().squaredNorm(),
              1e-9);
}

TEST(ClassicalScaling, BearsPointsThatAreAllAlikeAndRefusesOthers) {
  EXPECT_EQ(classical_scaling(Eigen::MatrixXd::Zero(4, 4), 2).points.norm(), 0);
  Eigen::MatrixXd bad = Eigen::MatrixXd::Zero(4, 4);
  bad(1, 2) = std::nan("");
  EXPECT_THROW(classical_scaling(bad, 2), DataError);
}

}  // namespace
}  // namespace mocaplm::scaling_test
