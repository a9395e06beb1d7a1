#include "emulator/reduction.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm::reduction_test {

namespace {

// Curves of a few patterns and some noise.
std::vector<Eigen::MatrixXd> curves(int count, Eigen::Index s, Eigen::Index t,
                                    double noise = 0.05) {
  Random random(3);
  const auto normal = [&](Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd m(rows, columns);
    for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = random.normal();
    return m;
  };
  const Eigen::MatrixXd space = normal(s, 4), time = normal(4, t), mean = normal(s, t);
  std::vector<Eigen::MatrixXd> flats;
  for (int k = 0; k < count; ++k) {
    const Eigen::MatrixXd mix = normal(4, 4);
    flats.push_back(mean + space * mix * time + noise * normal(s, t));
  }
  return flats;
}

double error_of(const Reduction& reduction, const std::vector<Eigen::MatrixXd>& flats,
                Eigen::Index d1, Eigen::Index d2) {
  double sum = 0;
  for (const Eigen::MatrixXd& flat : flats)
    sum += (reduction.restore(reduction.project(flat).topLeftCorner(d1, d2)) - flat).squaredNorm();
  return sum;
}

TEST(Reduction, AllComponentsLoseNothing) {
  const auto flats = curves(40, 6, 9);
  for (const std::string& name : reduction_names()) {
    const auto reduction = fit_reduction(name, flats, {100, 100, 0, 0});
    EXPECT_EQ(reduction->d1(), 6) << name;
    EXPECT_EQ(reduction->d2(), 9) << name;
    EXPECT_LT(error_of(*reduction, flats, 6, 9), 1e-18) << name;
  }
}

// The two steps of section 4.2, plainly.
TEST(Reduction, SequentialIsPcaOfColumnsThenOfCourses) {
  const auto flats = curves(12, 5, 30);
  const auto reduction = fit_reduction("SequentialPCA", flats, {3, 4, 0, 0}, 2);
  Eigen::VectorXd m = Eigen::VectorXd::Zero(5);
  for (const auto& flat : flats) m += flat.rowwise().mean() / 12;
  Eigen::MatrixXd sigma = Eigen::MatrixXd::Zero(5, 5);
  for (const auto& flat : flats)
    for (int t = 0; t < 30; ++t)
      sigma += (flat.col(t) - m) * (flat.col(t) - m).transpose() / (12 * 30 - 1.0);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(sigma);
  const Eigen::MatrixXd u = eigen.eigenvectors().rowwise().reverse().leftCols(3);
  for (const std::size_t k : {0u, 7u}) {
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 30);
    const Eigen::MatrixXd coefficients = reduction->project(flats[k]);
    for (int i = 0; i < 3; ++i) {
      Eigen::MatrixXd h(12, 30);
      for (int n = 0; n < 12; ++n)
        h.row(n) = u.col(i).transpose() * (flats[static_cast<std::size_t>(n)].colwise() - m);
      const Eigen::RowVectorXd mu = h.colwise().mean();
      const Eigen::MatrixXd centred = h.rowwise() - mu;
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeThinV);
      const Eigen::MatrixXd beta = svd.matrixV().leftCols(4);
      const Eigen::RowVectorXd a = centred.row(static_cast<Eigen::Index>(k)) * beta;
      for (int j = 0; j < 4; ++j) EXPECT_NEAR(std::abs(coefficients(i, j)), std::abs(a[j]), 1e-9);
      expected.row(i) = mu + a * beta.transpose();
    }
    const Eigen::MatrixXd restored = (u * expected).colwise() + m;
    EXPECT_LT((reduction->restore(coefficients) - restored).norm(), 1e-9);
  }
}

TEST(Reduction, MpcaIsTheBestOfEachWay) {
  const auto flats = curves(20, 7, 25);
  const auto mpca = fit_reduction("MPCA", flats, {3, 3, 0, 0});
  // Where each sample's mixing matrix is free, 4 x 4 patterns hold everything but noise.
  const auto all = fit_reduction("MPCA", flats, {4, 4, 0, 0});
  EXPECT_LT(error_of(*all, flats, 4, 4), 1.05 * 20 * 7 * 25 * 0.05 * 0.05);
  // At its stationary point, each basis is that of the scatter which the other one leaves.
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(7, 25);
  for (const auto& flat : flats) mean += flat / 20;
  double captured = 0, total = 0;
  for (const auto& flat : flats) {
    captured += mpca->project(flat).squaredNorm();
    total += (flat - mean).squaredNorm();
  }
  EXPECT_NEAR(error_of(*mpca, flats, 3, 3), total - captured, 1e-8 * total);
  // No random pair of bases captures more.
  Random random(5);
  for (int k = 0; k < 50; ++k) {
    Eigen::MatrixXd a(7, 3), b(25, 3);
    for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = random.normal();
    for (Eigen::Index i = 0; i < b.size(); ++i) b.data()[i] = random.normal();
    const Eigen::MatrixXd space =
        a.householderQr().householderQ() * Eigen::MatrixXd::Identity(7, 3);
    const Eigen::MatrixXd time =
        b.householderQr().householderQ() * Eigen::MatrixXd::Identity(25, 3);
    double other = 0;
    for (const auto& flat : flats)
      other += (space.transpose() * (flat - mean) * time).squaredNorm();
    EXPECT_LT(other, captured);
  }
}

TEST(Reduction, VarianceTargetsChooseTheNumbers) {
  const auto flats = curves(30, 8, 20, 1e-4);
  for (const std::string name : {"SequentialPCA", "MPCA"}) {
    const auto reduction = fit_reduction(name, flats, {1, 1, 0.999999, 0.999999});
    if (name == std::string("MPCA")) {
      EXPECT_EQ(reduction->d1(), 4);
    }
    EXPECT_LE(reduction->d2(), 4 + 1) << name;
    const auto some = fit_reduction(name, flats, {1, 1, 0.5, 0.5});
    EXPECT_LT(some->d2(), reduction->d2());
    double total = 0, left = error_of(*reduction, flats, reduction->d1(), reduction->d2());
    Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(8, 20);
    for (const auto& flat : flats) mean += flat / 30;
    for (const auto& flat : flats) total += (flat - mean).squaredNorm();
    EXPECT_LT(left, 1e-4 * total) << name;
  }
}

TEST(Reduction, MoreComponentsLoseLess) {
  const auto flats = curves(25, 6, 15, 0.5);
  for (const std::string name : {"SequentialPCA", "MPCA"}) {
    const auto reduction = fit_reduction(name, flats, {6, 10, 0, 0});
    for (Eigen::Index d = 1; d < 6; ++d)
      EXPECT_GE(error_of(*reduction, flats, d, 5), error_of(*reduction, flats, d + 1, 5)) << name;
    for (Eigen::Index d = 1; d < 10; ++d)
      EXPECT_GE(error_of(*reduction, flats, 4, d), error_of(*reduction, flats, 4, d + 1)) << name;
  }
}

TEST(Reduction, FilesGiveItBack) {
  const auto flats = curves(10, 5, 12);
  for (const std::string& name : reduction_names()) {
    const auto reduction = fit_reduction(name, flats, {3, 4, 0, 0});
    const auto again = read_reduction(parse_json(reduction->json().dump(), "x"), "x");
    EXPECT_EQ(again->project(flats[1]), reduction->project(flats[1])) << name;
    EXPECT_EQ(again->restore(again->project(flats[1])),
              reduction->restore(reduction->project(flats[1])))
        << name;
    Json broken = reduction->json();
    broken[name == "MPCA" ? "space" : "basis"]["rows"] = 4;
    EXPECT_THROW(read_reduction(broken, "x"), DataError);
    broken = reduction->json();
    broken["extra"] = 1;
    EXPECT_THROW(read_reduction(broken, "x"), DataError);
  }
}

TEST(Reduction, BadInputIsRefused) {
  auto flats = curves(10, 5, 12);
  EXPECT_THROW(fit_reduction("PCA", flats, {}), UsageError);
  EXPECT_THROW(fit_reduction("MPCA", {flats[0], flats[1]}, {}), DataError);
  EXPECT_THROW(fit_reduction("MPCA", {flats[0], flats[0], flats[0]}, {}), DataError);
  // Fewer curves than components, and a coordinate that never changes.
  for (auto& flat : flats) flat.row(2).setConstant(0.25);
  const std::vector<Eigen::MatrixXd> four(flats.begin(), flats.begin() + 4);
  const auto reduction = fit_reduction("SequentialPCA", four, {10, 10, 0, 0});
  EXPECT_EQ(reduction->d2(), 3);
  EXPECT_LT(error_of(*reduction, four, reduction->d1(), 3), 1e-18);
  flats[3](1, 1) = std::nan("");
  EXPECT_THROW(fit_reduction("SequentialPCA", flats, {}), DataError);
}

}  // namespace

}  // namespace mocaplm::reduction_test
