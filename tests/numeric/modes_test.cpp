#include "numeric/modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm::modes_test {
namespace {

Eigen::MatrixXf distances(const Eigen::MatrixXd& x) {
  Eigen::MatrixXf d(x.rows(), x.rows());
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (Eigen::Index j = 0; j < x.rows(); ++j) d(i, j) = float((x.row(i) - x.row(j)).norm());
  return d;
}

// `clusters` balls of unlike sizes around corners, members in turn.
Eigen::MatrixXd balls(Eigen::Index n, int clusters, double radius, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd x(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int c = int(i % clusters);
    for (Eigen::Index k = 0; k < 3; ++k)
      x(i, k) = 10 * ((c >> k) & 1) + 4 * (c == 7) + radius * random.normal();
  }
  return x;
}

TEST(FindModes, FindsTheNumberOfClusters) {
  for (const int clusters : {2, 3, 5, 8}) {
    const Modes modes = find_modes(distances(balls(400, clusters, 1.2, 1)));
    ASSERT_EQ(modes.modes.size(), std::size_t(clusters));
    // Each ball has one cluster of its own, and the mode lies near its middle.
    std::set<int> seen;
    for (std::size_t i = 0; i < 400; ++i) {
      EXPECT_EQ(modes.cluster[i], modes.cluster[i % std::size_t(clusters)]);
      seen.insert(modes.cluster[i]);
    }
    EXPECT_EQ(seen.size(), std::size_t(clusters));
  }
}

TEST(FindModes, ModesAreLocalMaximaOfTheDensity) {
  const Eigen::MatrixXf d = distances(balls(200, 4, 2.5, 2));
  const Modes modes = find_modes(d);
  const auto neighbours = [&](Eigen::Index i) {
    return (d.col(i).array() <= float(modes.epsilon)).count();
  };
  for (const Eigen::Index mode : modes.modes)
    for (Eigen::Index j = 0; j < d.rows(); ++j)
      if (d(j, mode) <= float(modes.epsilon)) {
        EXPECT_GE(neighbours(mode), neighbours(j));
      }
  for (Eigen::Index i = 0; i < d.rows(); ++i)
    for (const Eigen::Index mode : modes.modes)
      EXPECT_LE(d(i, modes.modes[std::size_t(modes.cluster[std::size_t(i)])]), d(i, mode));
}

// F by the definition, over coordinates: with squared distances T - W is the ordinary variance
// between the clusters.
TEST(FindModes, RatioIsTheAnalysisOfVariance) {
  const Eigen::MatrixXd x = balls(120, 3, 2, 3);
  const Modes modes = find_modes(distances(x));
  const auto k = Eigen::Index(modes.modes.size());
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(k, 3);
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(k);
  for (Eigen::Index i = 0; i < 120; ++i) {
    sums.row(modes.cluster[std::size_t(i)]) += x.row(i);
    sizes[modes.cluster[std::size_t(i)]] += 1;
  }
  double within = 0;
  for (Eigen::Index i = 0; i < 120; ++i) {
    const int c = modes.cluster[std::size_t(i)];
    within += (x.row(i) - sums.row(c) / sizes[c]).squaredNorm();
  }
  const double total = (x.rowwise() - x.colwise().mean()).squaredNorm();
  EXPECT_NEAR(modes.ratio, (total - within) / double(k - 1) / (within / double(120 - k)),
              1e-3 * modes.ratio);
}

TEST(FindModes, CountCanBeAskedFor) {
  ModeOptions options;
  options.grid = 200;
  for (const Eigen::Index count : {1, 5, 8}) {
    options.count = count;
    EXPECT_EQ(Eigen::Index(find_modes(distances(balls(300, 8, 1.5, 4)), options).modes.size()),
              count);
  }
}

TEST(FindModes, BearsLittleDataAndRefusesBadData) {
  EXPECT_EQ(find_modes(Eigen::MatrixXf::Zero(1, 1)).modes, (std::vector<Eigen::Index>{0}));
  EXPECT_EQ(find_modes(Eigen::MatrixXf::Zero(30, 30)).modes.size(), 1u);
  EXPECT_EQ(find_modes(distances(balls(2, 2, 1, 5))).cluster.size(), 2u);
  Eigen::MatrixXf bad = Eigen::MatrixXf::Zero(3, 3);
  bad(1, 2) = std::nanf("");
  EXPECT_THROW(find_modes(bad), DataError);
  EXPECT_THROW(find_modes(Eigen::MatrixXf::Zero(3, 2)), DataError);
  EXPECT_THROW(find_modes(Eigen::MatrixXf(0, 0)), DataError);
}

}  // namespace
}  // namespace mocaplm::modes_test
