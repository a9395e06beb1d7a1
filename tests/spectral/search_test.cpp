// The search is exact: against plain loops over all rows, with and without sketches.
#include "spectral/search.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/random.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"

namespace mocaplm::search_test {
namespace {

// Windows that lie around a few centres, so that neighbours are close and bounds matter.
std::vector<Series> clustered(std::size_t count, Eigen::Index frames, Eigen::Index channels) {
  Random random(5);
  std::vector<Series> centres, all;
  const auto noise = [&](double scale) {
    Series series(frames, channels);
    for (Eigen::Index i = 0; i < series.size(); ++i)
      series.data()[i] = static_cast<float>(scale * random.normal());
    return series;
  };
  for (int c = 0; c < 12; ++c) centres.push_back(noise(1));
  for (std::size_t i = 0; i < count; ++i)
    all.push_back(Series(random.uniform(0.5, 2) * centres[i % 12] + noise(0.3)));
  return all;
}

SpectralConfig config_of(bool sketched) {
  SpectralConfig config;
  config.feature = sketched ? "pose" : "dct";
  config.window = 32;
  config.coefficients = 8;
  config.joints = {"pelvis", "head"};  // 6 channels: 192 or 48 dimensions
  return config;
}

struct Made {
  TemporaryFolder folder;
  std::vector<Series> windows;
  std::unique_ptr<SpectralIndex> index;

  explicit Made(bool sketched, std::size_t count = 3000) {
    windows = clustered(count, 32, 6);
    windows[7].setZero();
    IndexWriter writer(folder / "x.index", config_of(sketched), windows);
    for (std::size_t i = 0; i < count; i += 10) {  // ten windows a clip
      const std::vector<Series> part(windows.begin() + std::ptrdiff_t(i),
                                     windows.begin() + std::ptrdiff_t(i + 10));
      writer.add("clip" + std::to_string(i / 10), {0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
                 writer.features().rows(part));
    }
    writer.finish("made up");
    index = std::make_unique<SpectralIndex>(folder / "x.index");
  }
};

// By the definition, in double precision.
std::vector<Eigen::Index> plain(const Series& rows, const Eigen::RowVectorXf& query, Eigen::Index k,
                                Measure measure, const Scope& scope) {
  std::vector<std::pair<double, Eigen::Index>> all;
  const Eigen::RowVectorXd q = query.cast<double>();
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    if (!scope.empty() && scope[static_cast<std::size_t>(i / 10)] == 0) continue;
    const Eigen::RowVectorXd x = rows.row(i).cast<double>();
    const double lengths = q.norm() * x.norm();
    all.emplace_back(
        measure == Measure::cosine ? (lengths > 0 ? -q.dot(x) / lengths : 0) : (q - x).norm(), i);
  }
  std::sort(all.begin(), all.end());
  std::vector<Eigen::Index> rows_found;
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(k, Eigen::Index(all.size())); ++i)
    rows_found.push_back(all[std::size_t(i)].second);
  return rows_found;
}

std::vector<Eigen::Index> rows_of(const std::vector<Neighbour>& found) {
  std::vector<Eigen::Index> rows;
  for (const Neighbour& one : found) rows.push_back(one.row);
  return rows;
}

class Searching : public testing::TestWithParam<bool> {};

TEST_P(Searching, FindsWhatPlainLoopsFind) {
  const Made made(GetParam());
  const SpectralIndex& index = *made.index;
  EXPECT_EQ(index.sketch_dimensions(), GetParam() ? kSketch : 0);
  const Series rows = index.features().rows(made.windows);
  Scope scope(300, 1);
  for (std::size_t c = 0; c < 300; c += 3) scope[c] = 0;
  for (const Measure measure : {Measure::cosine, Measure::euclidean})
    for (const Scope& where : {Scope{}, scope}) {
      std::vector<Eigen::Index> asked = {0, 11, 500, 2999};
      const auto many = nearest_of_many(
          index, Series(rows(asked, Eigen::all)), 10, measure, [&](Eigen::Index) { return where; },
          [](Eigen::Index) { return -1; }, 2);
      for (std::size_t q = 0; q < asked.size(); ++q) {
        const auto wanted = plain(rows, rows.row(asked[q]), 10, measure, where);
        SearchCounts counts;
        const auto found =
            nearest(index, rows.row(asked[q]).data(), 10, measure, where, 2, &counts);
        EXPECT_EQ(rows_of(found), wanted);
        EXPECT_EQ(rows_of(many[q]), wanted);
        if (GetParam()) {  // the sketches rule out most
          EXPECT_LT(counts.compared, 2000);
          EXPECT_LT(counts.compared, counts.sketched + 20);
        }
        for (const Neighbour& one : found) {
          EXPECT_NEAR(one.distance, (rows.row(one.row) - rows.row(asked[q])).norm(), 2e-3);
          EXPECT_NEAR(one.similarity,
                      rows.row(one.row).normalized().dot(rows.row(asked[q]).normalized()), 1e-5);
        }
      }
    }
}

INSTANTIATE_TEST_SUITE_P(All, Searching, testing::Bool(),
                         [](const auto& info) { return info.param ? "sketched" : "direct"; });

TEST(Search, BoundsHoldForEveryPair) {
  const Made made(true, 200);
  const auto rows = made.index->rows();
  const auto sketch = made.index->sketch();
  const auto coarse = made.index->coarse();
  ASSERT_EQ(coarse.cols(), kCoarse);
  const Eigen::MatrixXf exact = rows * rows.transpose(), bound = sketch * sketch.transpose(),
                        first = coarse * coarse.transpose();
  EXPECT_GE((bound - exact).minCoeff(), -1e-5f);
  EXPECT_GE((first - bound).minCoeff(), -1e-5f);
}

// Rows that lie inside the sketch's space but for a ten-thousandth: in single precision the square
// of what is left out is lost, and a length of 0 would make the bound too low.
TEST(Search, BoundsHoldWhereHardlyAnythingIsLeftOut) {
  Random random(9);
  const Eigen::Index d = 192, inside = 63;
  Eigen::MatrixXd noise(d, inside + 1);
  for (Eigen::Index i = 0; i < noise.size(); ++i) noise.data()[i] = random.normal();
  const Eigen::MatrixXd axes = Eigen::HouseholderQR<Eigen::MatrixXd>(noise).householderQ() *
                               Eigen::MatrixXd::Identity(d, inside + 1);
  const Eigen::VectorXd outside = axes.col(inside);
  Eigen::MatrixXd rows(200, d);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    Eigen::VectorXd within = axes.leftCols(inside) * noise.topRows(inside).col(i % inside);
    rows.row(i) =
        (within.normalized() + (i % 2 == 0 ? 1e-4 : 0.5) * outside).normalized().transpose();
  }
  const Eigen::MatrixXf basis = axes.leftCols(inside).cast<float>();
  const Eigen::MatrixXd sketch = make_sketch(Series(rows.cast<float>()), basis).cast<double>();
  EXPECT_GE((sketch * sketch.transpose() - rows * rows.transpose()).minCoeff(), -1e-6);
  // And not much too high.
  EXPECT_LE((sketch * sketch.transpose() - rows * rows.transpose()).maxCoeff(), 2e-3);
}

TEST(Search, ZerosAndFewRows) {
  const Made made(true, 20);
  const SpectralIndex& index = *made.index;
  const Eigen::VectorXf zero = Eigen::VectorXf::Zero(index.dimensions());
  const auto found = nearest(index, zero.data(), 50, Measure::euclidean);
  ASSERT_EQ(found.size(), 20u);
  EXPECT_EQ(found[0].row, 7);
  EXPECT_EQ(found[0].distance, 0);
  for (const Neighbour& one : nearest(index, zero.data(), 5, Measure::cosine))
    EXPECT_EQ(one.similarity, 0);
  EXPECT_TRUE(nearest(index, zero.data(), 5, Measure::cosine, Scope(2, 0)).empty());
  EXPECT_TRUE(contains(
      refusal<UsageError>([&] { nearest(index, zero.data(), 0, Measure::cosine); }), "k is 0"));
  EXPECT_TRUE(contains(refusal<UsageError>([] { parse_measure("cosin"); }), "cosine"));
}

}  // namespace
}  // namespace mocaplm::search_test
