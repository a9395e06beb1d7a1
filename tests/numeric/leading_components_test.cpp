#include "numeric/leading_components.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/error.h"
#include "common/random.h"
#include "numeric/components.h"
#include "support/refusal.h"

namespace mocaplm::leading_components_test {
namespace {

// n samples of d channels whose variances fall, mixed by products with random numbers.
Eigen::MatrixXd samples(Eigen::Index n, Eigen::Index d, Eigen::Index rank) {
  Random random(5);
  Eigen::MatrixXd sources(n, rank), mix(rank, d);
  for (Eigen::Index i = 0; i < sources.size(); ++i) sources.data()[i] = random.normal();
  for (Eigen::Index i = 0; i < mix.size(); ++i) mix.data()[i] = random.normal();
  for (Eigen::Index r = 0; r < rank; ++r) mix.row(r) *= std::pow(0.6, double(r));
  return (sources * mix).rowwise() + Eigen::RowVectorXd::Constant(d, 2.5);
}

TEST(LeadingComponents, AreThePrincipalOnes) {
  const Eigen::MatrixXd x = samples(300, 40, 12);
  const Components exact = principal_components(x, 5);
  const LeadingComponents found = leading_components(x.cast<float>(), 5);
  EXPECT_LT((found.mean.cast<double>() - exact.mean).norm(), 1e-4);
  EXPECT_LT((found.basis.cast<double>() - exact.analysis).cwiseAbs().maxCoeff(), 1e-3);
}

// Without centring the mean is a direction as any other.
TEST(LeadingComponents, SpanTheMeanWhenNotCentred) {
  const Eigen::MatrixXf x = samples(200, 30, 3).cast<float>();
  const LeadingComponents found = leading_components(x, 4, 1, false);
  EXPECT_EQ(found.mean.norm(), 0);
  EXPECT_LT((x - x * found.basis * found.basis.transpose()).norm(), 1e-4f * x.norm());
}

TEST(LeadingComponents, StayOrthonormalBeyondTheRank) {
  for (const Eigen::Index n : {1, 3, 50}) {
    const LeadingComponents found = leading_components(samples(n, 20, 4).cast<float>(), 20);
    const Eigen::MatrixXf gram = found.basis.transpose() * found.basis;
    EXPECT_LT((gram - Eigen::MatrixXf::Identity(20, 20)).cwiseAbs().maxCoeff(), 1e-4f) << n;
  }
  const LeadingComponents flat = leading_components(Eigen::MatrixXf::Constant(9, 6, 3), 2);
  EXPECT_LT((flat.basis.transpose() * flat.basis - Eigen::Matrix2f::Identity()).norm(), 1e-4f);
}

TEST(LeadingComponents, RefuseWhatIsNotFinite) {
  Eigen::MatrixXf x = Eigen::MatrixXf::Ones(4, 4);
  x(2, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(contains(refusal([&] { leading_components(x, 2); }), "not all finite"));
}

}  // namespace
}  // namespace mocaplm::leading_components_test
