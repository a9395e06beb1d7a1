#include "numeric/components.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm::components_test {
namespace {

Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index cols, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd x(rows, cols);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.normal();
  return x;
}

// Correlated columns with different scales and a mean.
Eigen::MatrixXd correlated(Eigen::Index rows, Eigen::Index cols) {
  Eigen::MatrixXd x = noise(rows, cols, 5);
  for (Eigen::Index c = 0; c < cols; ++c) x.col(c) *= 1.0 / (1.0 + double(c));
  return (x * noise(cols, cols, 6)).rowwise() + noise(1, cols, 7).row(0);
}

TEST(PrincipalComponents, AreTheSingularVectors) {
  const Eigen::MatrixXd x = correlated(200, 12);
  const Eigen::MatrixXd centred = x.rowwise() - x.colwise().mean();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeThinV);
  for (const Eigen::Index k : {1, 5, 12}) {
    const Components pca = principal_components(x, k);
    ASSERT_EQ(pca.count(), k);
    for (Eigen::Index i = 0; i < k; ++i)
      EXPECT_NEAR(std::abs(pca.analysis.col(i).dot(svd.matrixV().col(i))), 1, 1e-9);
    // Eckart and Young: what is lost is what the other singular values hold.
    const double lost = (pca.restore(pca.project(x)) - x).squaredNorm();
    EXPECT_NEAR(lost, svd.singularValues().tail(12 - k).squaredNorm(), 1e-8);
    EXPECT_LT((pca.synthesis * pca.analysis - Eigen::MatrixXd::Identity(k, k)).norm(), 1e-10);
  }
}

TEST(PrincipalComponents, WorkWithFewerSamplesThanDimensions) {
  const Eigen::MatrixXd x = noise(3, 10, 8);
  const Components pca = principal_components(x, 10);
  EXPECT_LT((pca.restore(pca.project(x)) - x).norm(), 1e-9);
  Eigen::MatrixXd bad = x;
  bad(1, 1) = std::nan("");
  EXPECT_THROW(principal_components(bad, 2), DataError);
}

// Four sources that are not Gaussian, mixed: each is found again, up to order and sign.
TEST(IndependentComponents, UnmixSources) {
  const Eigen::Index n = 4000;
  Random random(9);
  Eigen::MatrixXd sources(n, 4);
  for (Eigen::Index t = 0; t < n; ++t)
    sources.row(t) << std::sin(0.05 * double(t)), (t / 37) % 2 == 0 ? 1.0 : -1.0,
        random.uniform(-1, 1), std::pow(random.normal(), 3);
  const Eigen::MatrixXd mixing = noise(4, 6, 10);
  const Eigen::MatrixXd x = (sources * mixing).rowwise() + noise(1, 6, 11).row(0);
  IcaReport report;
  const Components ica = independent_components(x, 6, 1, &report);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(ica.count(), 4) << "the mix has rank 4";
  const Eigen::MatrixXd found = ica.project(x);
  const auto correlation = [&](Eigen::Index source, Eigen::Index component) {
    const Eigen::VectorXd a = sources.col(source).array() - sources.col(source).mean();
    const Eigen::VectorXd b = found.col(component).array() - found.col(component).mean();
    return std::abs(a.dot(b)) / (a.norm() * b.norm());
  };
  for (Eigen::Index s = 0; s < 4; ++s) {
    double best = 0;
    for (Eigen::Index c = 0; c < 4; ++c) best = std::max(best, correlation(s, c));
    EXPECT_GT(best, 0.99) << s;
  }
  EXPECT_LT((ica.restore(found) - x).norm(), 1e-8 * x.norm());
  for (Eigen::Index c = 0; c < 4; ++c) EXPECT_NEAR(ica.synthesis.row(c).norm(), 1, 1e-12);
}

TEST(IndependentComponents, SpanThePrincipalOnesAndRepeat) {
  const Eigen::MatrixXd x = correlated(500, 8);
  const Components pca = principal_components(x, 3), ica = independent_components(x, 3, 2);
  EXPECT_LT((ica.restore(ica.project(x)) - pca.restore(pca.project(x))).norm(), 1e-8);
  EXPECT_LT((ica.synthesis * ica.analysis - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-9);
  EXPECT_EQ((independent_components(x, 3, 2).analysis - ica.analysis).norm(), 0);
  // Largest variance first.
  const Eigen::MatrixXd z = ica.project(x);
  for (Eigen::Index c = 1; c < 3; ++c) EXPECT_GE(z.col(c - 1).norm(), z.col(c).norm() * 0.999999);
}

}  // namespace
}  // namespace mocaplm::components_test
