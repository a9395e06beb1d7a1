#include "emulator/coefficients.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "emulator/gaussians.h"

namespace mocaplm::coefficients_test {

namespace {

Eigen::MatrixXd correlated(int m, int d, std::uint64_t seed = 1) {
  Random random(seed);
  Eigen::MatrixXd mix(d, d), x(m, d);
  for (Eigen::Index i = 0; i < mix.size(); ++i) mix.data()[i] = random.normal();
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.normal();
  return (x * mix).rowwise() + Eigen::RowVectorXd::LinSpaced(d, 1, 2);
}

Eigen::MatrixXd draw(const CoefficientModel& model, int count) {
  Random random(9);
  return model.sample(count, random);
}

Eigen::MatrixXd covariance(const Eigen::MatrixXd& x) {
  const Eigen::MatrixXd c = x.rowwise() - x.colwise().mean();
  return c.transpose() * c / static_cast<double>(x.rows() - 1);
}

// The density of a Gaussian, with inverse and determinant.
double plain_log_density(const Eigen::VectorXd& x, const Eigen::VectorXd& mean,
                         const Eigen::MatrixXd& c) {
  return -0.5 * static_cast<double>(x.size()) * std::log(2 * kPi) -
         0.5 * std::log(c.determinant()) - 0.5 * (x - mean).dot(c.inverse() * (x - mean));
}

TEST(ShrunkCovariance, IsSchaeferAndStrimmers) {
  const Eigen::MatrixXd x = correlated(15, 6);
  double share = 0;
  const Eigen::MatrixXd shrunk = shrunk_covariance(x, -1, &share);
  const Eigen::MatrixXd s = covariance(x);
  const double n = 15;
  double above = 0, below = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      if (i == j) continue;
      double w[15], mean = 0, var = 0;
      for (int k = 0; k < 15; ++k) {
        w[k] = (x(k, i) - x.col(i).mean()) * (x(k, j) - x.col(j).mean()) /
               std::sqrt(s(i, i) * s(j, j));
        mean += w[k] / n;
      }
      for (const double each : w) var += (each - mean) * (each - mean);
      above += n / std::pow(n - 1, 3) * var;
      below += std::pow(n / (n - 1) * mean, 2);
    }
  EXPECT_NEAR(share, std::min(1.0, above / below), 1e-10);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(shrunk(i, j), i == j ? s(i, i) : (1 - share) * s(i, j), 1e-7);
  EXPECT_LT((shrunk_covariance(x, 0) - s).norm(), 1e-7);
  EXPECT_LT((shrunk_covariance(x, 1) - Eigen::MatrixXd(s.diagonal().asDiagonal())).norm(), 1e-7);
}

TEST(ShrunkCovariance, FewSamplesAndConstantOnesStayInvertible) {
  Eigen::MatrixXd x = correlated(5, 20);
  x.col(3).setConstant(2);
  x.col(4) = x.col(5);
  const Eigen::LLT<Eigen::MatrixXd> llt(shrunk_covariance(x, -1));
  EXPECT_EQ(llt.info(), Eigen::Success);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(shrunk_covariance(x.leftCols(2), 0)).info(),
            Eigen::Success);
}

TEST(Coefficients, GaussianDensityAndSamples) {
  const Eigen::MatrixXd x = correlated(60, 4);
  const Eigen::VectorXd mean = x.colwise().mean().transpose();
  SchemeOptions options;
  options.shrinkage = 0;
  const auto mvg = fit_coefficients("MVG", x, options), ig = fit_coefficients("IG", x, options);
  const Eigen::MatrixXd c = covariance(x);
  const Eigen::MatrixXd diagonal = c.diagonal().asDiagonal();
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(mvg->log_density(x.row(k).transpose()),
                plain_log_density(x.row(k).transpose(), mean, c), 1e-6);
    EXPECT_NEAR(ig->log_density(x.row(k).transpose()),
                plain_log_density(x.row(k).transpose(), mean, diagonal), 1e-6);
  }
  EXPECT_LT((covariance(draw(*mvg, 40000)) - c).norm(), 0.03 * c.norm());
  EXPECT_LT((covariance(draw(*ig, 40000)) - diagonal).norm(), 0.03 * c.norm());
  EXPECT_LT((draw(*mvg, 40000).colwise().mean().transpose() - mean).norm(), 0.05);
}

// Every density is one: its integral, by importance sampling from a wide Gaussian, is 1.
TEST(Coefficients, DensitiesIntegrateToOne) {
  Eigen::MatrixXd x = correlated(40, 2);
  x.topRows(15).rowwise() += Eigen::RowVector2d(8, -3);
  const Eigen::VectorXd centre = x.colwise().mean().transpose();
  const Eigen::MatrixXd wide = 3 * covariance(x);
  const Gaussians from(Eigen::VectorXd::Ones(1), centre.transpose(), wide);
  for (const std::string& name : coefficient_model_names()) {
    const auto model = fit_coefficients(name, x, {});
    Random random(4);
    double sum = 0;
    const int count = 20000;
    for (int k = 0; k < count; ++k) {
      const Eigen::VectorXd at = from.sample(1, random).row(0).transpose();
      sum += std::exp(model->log_density(at) - from.log_density(at)) / count;
    }
    EXPECT_NEAR(sum, 1, 0.06) << name;
  }
}

TEST(Coefficients, BootstrapKeepsMeanAndCovariance) {
  const Eigen::MatrixXd x = correlated(30, 5);
  for (const double bandwidth : {0.5, 1.0, 0.0}) {
    double used = 0;
    const auto model = fit_bootstrap(x, 0, bandwidth, true, &used);
    EXPECT_GT(used, 0);
    const Eigen::MatrixXd drawn = draw(*model, 60000);
    const Eigen::MatrixXd c = covariance(x) * 29.5 / 30;
    EXPECT_LT((covariance(drawn) - c).norm(), 0.05 * c.norm()) << bandwidth;
    EXPECT_LT((drawn.colwise().mean() - x.colwise().mean()).norm(), 0.1);
  }
  // A kernel on each sample, plainly.
  const auto model = fit_bootstrap(x, 0, 1);
  const double rule = std::pow(4.0 / (7 * 30), 1.0 / 9), together = 1 / std::sqrt(1 + rule * rule);
  const Eigen::RowVectorXd mean = x.colwise().mean();
  double sum = 0;
  for (int k = 0; k < 30; ++k)
    sum += std::exp(plain_log_density(x.row(3).transpose(),
                                      (mean + together * (x.row(k) - mean)).transpose(),
                                      std::pow(rule * together, 2) * covariance(x))) /
           30;
  EXPECT_NEAR(model->log_density(x.row(3).transpose()), std::log(sum), 1e-6);
}

TEST(Coefficients, MixtureFindsClusters) {
  Random random(6);
  Eigen::MatrixXd x(90, 3);
  for (int k = 0; k < 90; ++k)
    for (int i = 0; i < 3; ++i) x(k, i) = random.normal() + (k % 3 == i ? 9 : 0);
  EXPECT_EQ(choose_gaussians(x, 8, -1), 3);
  const auto model = fit_gaussians(x, 3, -1);
  ASSERT_EQ(model->count(), 3);
  for (int c = 0; c < 3; ++c) {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(3);
    for (int k = c; k < 90; k += 3) mean += x.row(k) / 30;
    double nearest = 1e9;
    for (int g = 0; g < 3; ++g) nearest = std::min(nearest, (model->means().row(g) - mean).norm());
    EXPECT_LT(nearest, 1e-9);
    EXPECT_NEAR(model->weights()[c], 1.0 / 3, 1e-9);
  }
  // One Gaussian that is one.
  const Eigen::MatrixXd plain = correlated(60, 4);
  EXPECT_EQ(choose_gaussians(plain, 8, -1), 1);
}

TEST(Coefficients, CopulaKeepsMarginalsAndDependence) {
  // A marginal of two humps, and one that depends on it.
  Random random(7);
  Eigen::MatrixXd x(200, 2);
  for (int k = 0; k < 200; ++k) {
    const double z = random.normal();
    x(k, 0) = (z > 0 ? 3 : -3) + 0.5 * random.normal();
    x(k, 1) = z + 0.2 * random.normal();
  }
  SchemeOptions options;
  options.shrinkage = 0;
  const auto model = fit_coefficients("Copula", x, options);
  const Eigen::MatrixXd drawn = draw(*model, 20000);
  EXPECT_NEAR(std::sqrt(covariance(drawn)(0, 0) / covariance(x)(0, 0)), 1, 0.03);
  // Few draws between the humps, as in the data; a Gaussian would put a quarter there.
  const auto between = [](const Eigen::MatrixXd& y) {
    return static_cast<double>((y.col(0).array().abs() < 1).count()) /
           static_cast<double>(y.rows());
  };
  EXPECT_LT(between(x), 0.01);
  EXPECT_LT(between(drawn), 0.06);
  // A positive dependence of about the same rank correlation.
  const auto concordance = [](const Eigen::MatrixXd& y) {
    double sum = 0;
    for (int i = 0; i < 200; ++i)
      for (int j = 0; j < i; ++j) sum += (y(i, 0) - y(j, 0)) * (y(i, 1) - y(j, 1)) > 0 ? 1 : -1;
    return sum / (200 * 199 / 2);
  };
  EXPECT_NEAR(concordance(drawn), concordance(x), 0.15);
}

// A mixture's means (M, d) and covariances, written out from emulator/local.h.
struct PlainKernels {
  Eigen::MatrixXd centres;
  std::vector<Eigen::MatrixXd> covariances;
};

PlainKernels plain_kernels(const Eigen::MatrixXd& x, int k, double spread, double floor) {
  const auto m = static_cast<int>(x.rows());
  PlainKernels kernels;
  kernels.centres.resize(m, x.cols());
  const Eigen::VectorXd variances = covariance(x).diagonal();
  Eigen::VectorXd around = Eigen::VectorXd::Zero(x.cols());
  for (int i = 0; i < m; ++i) {
    std::vector<std::pair<double, int>> order;
    for (int j = 0; j < m; ++j) order.emplace_back((x.row(i) - x.row(j)).norm(), j);
    std::sort(order.begin(), order.end());
    Eigen::MatrixXd near(k + 1, x.cols());
    for (int j = 0; j <= k; ++j) near.row(j) = x.row(order[static_cast<std::size_t>(j)].second);
    const Eigen::RowVectorXd mean = near.colwise().mean();
    kernels.centres.row(i) = mean + std::sqrt(1 - spread * spread) * (x.row(i) - mean);
    kernels.covariances.push_back(spread * spread * (1 - floor) * covariance(near));
    around += covariance(near).diagonal() / m;
  }
  for (Eigen::MatrixXd& c : kernels.covariances) c.diagonal() += spread * spread * floor * around;
  // The whole is brought back to the samples' mean and variances, coefficient by coefficient.
  const Eigen::RowVectorXd middle = kernels.centres.colwise().mean();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(x.cols(), x.cols());
  for (int i = 0; i < m; ++i) {
    const Eigen::RowVectorXd away = kernels.centres.row(i) - middle;
    whole += (away.transpose() * away + kernels.covariances[static_cast<std::size_t>(i)]) / m;
  }
  const Eigen::VectorXd back = variances.cwiseQuotient(whole.diagonal()).cwiseSqrt();
  kernels.centres =
      ((kernels.centres.rowwise() - middle) * back.asDiagonal()).rowwise() + x.colwise().mean();
  for (Eigen::MatrixXd& c : kernels.covariances) c = back.asDiagonal() * c * back.asDiagonal();
  return kernels;
}

TEST(Coefficients, LocalKernelsPlainly) {
  const Eigen::MatrixXd x = correlated(12, 3);
  SchemeOptions options;
  options.neighbours = 4;
  options.spread = 0.7;
  options.floor = 0.3;
  const auto model = fit_coefficients("Local", x, options);
  const PlainKernels plain = plain_kernels(x, 4, 0.7, 0.3);
  const Eigen::VectorXd at = x.row(5).transpose() + Eigen::Vector3d(0.1, -0.2, 0.05);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 3);
  double sum = 0;
  for (int i = 0; i < 12; ++i) {
    const Eigen::MatrixXd& c = plain.covariances[static_cast<std::size_t>(i)];
    const Eigen::RowVectorXd away = plain.centres.row(i) - x.colwise().mean();
    expected += (away.transpose() * away + c) / 12;
    sum += std::exp(plain_log_density(at, plain.centres.row(i).transpose(), c)) / 12;
  }
  EXPECT_NEAR(model->log_density(at), std::log(sum), 1e-6);
  const Eigen::MatrixXd drawn = draw(*model, 60000);
  EXPECT_LT((covariance(drawn) - expected).norm(), 0.03 * expected.norm());
  EXPECT_LT((drawn.colwise().mean() - x.colwise().mean()).norm(), 0.05);
}

// Whatever the kernels' width, each coefficient varies as in the data. A cluster does nearly so, up
// to the default spread; at spread 1 nothing of the samples' own places is left, and it gets
// narrower.
TEST(Coefficients, LocalKeepsTheVarianceOfTheWholeAndOfClusters) {
  Random random(8);
  Eigen::MatrixXd x(80, 6);
  for (int k = 0; k < 80; ++k)
    for (int i = 0; i < 6; ++i) x(k, i) = random.normal() * (i + 1) + (k < 40 ? 0 : 60);
  for (const double spread : {0.1, 0.7, 1.0}) {
    SchemeOptions options;
    options.spread = spread;
    options.neighbours = 8;
    const Eigen::MatrixXd drawn = draw(*fit_coefficients("Local", x, options), 40000);
    const Eigen::VectorXd ratio =
        covariance(drawn).diagonal().cwiseQuotient(covariance(x).diagonal());
    EXPECT_LT((ratio.array() - 1).abs().maxCoeff(), 0.02) << spread;
    // The first cluster's.
    std::vector<Eigen::Index> own;
    for (Eigen::Index k = 0; k < drawn.rows(); ++k)
      if (drawn.row(k).mean() < 30) own.push_back(k);
    EXPECT_NEAR(static_cast<double>(own.size()) / 40000, 0.5, 0.01);
    Eigen::MatrixXd cluster(static_cast<Eigen::Index>(own.size()), 6);
    for (std::size_t k = 0; k < own.size(); ++k)
      cluster.row(static_cast<Eigen::Index>(k)) = drawn.row(own[k]);
    const double share = covariance(cluster).trace() / covariance(x.topRows(40)).trace();
    if (spread < 1) {
      EXPECT_NEAR(share, 1, 0.15) << spread;
    } else {
      EXPECT_GT(share, 0.5);
      EXPECT_LT(share, 1);
    }
  }
}

TEST(Coefficients, StratifiedDrawsHaveTheirShare) {
  Random random(11);
  Eigen::VectorXd weights(4);
  weights << 0.1, 0.4, 0.25, 0.25;
  Eigen::Vector4d total = Eigen::Vector4d::Zero();
  for (int round = 0; round < 2000; ++round) {
    Eigen::Vector4d counts = Eigen::Vector4d::Zero();
    for (const Eigen::Index k : draw_indices(weights, 7, true, random)) counts[k] += 1;
    for (int k = 0; k < 4; ++k) EXPECT_LT(std::abs(counts[k] - 7 * weights[k]), 1);
    total += counts;
  }
  EXPECT_LT((total / 14000 - weights).cwiseAbs().maxCoeff(), 0.01);
  total.setZero();
  double squares = 0;
  for (int round = 0; round < 4000; ++round) {
    Eigen::Vector4d counts = Eigen::Vector4d::Zero();
    for (const Eigen::Index k : draw_indices(weights, 7, false, random)) counts[k] += 1;
    total += counts;
    squares += std::pow(counts[1] - 2.8, 2) / 4000;
  }
  EXPECT_LT((total / 28000 - weights).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_NEAR(squares, 7 * 0.4 * 0.6, 0.15);
}

TEST(Coefficients, FilesGiveThemBack) {
  const Eigen::MatrixXd x = correlated(20, 3);
  for (const std::string& name : coefficient_model_names()) {
    const auto model = fit_coefficients(name, x, {});
    const auto again = read_coefficients(parse_json(model->json().dump(), "x"), "x");
    Random a(3), b(3);
    EXPECT_LT((model->sample(5, a) - again->sample(5, b)).norm(), 1e-9) << name;
    EXPECT_NEAR(model->log_density(x.row(0).transpose()), again->log_density(x.row(0).transpose()),
                1e-9);
    Json broken = model->json();
    broken[name == "Local" ? "neighbours" : "factor"]["values"][0] = -1;
    EXPECT_THROW(read_coefficients(broken, "x"), DataError) << name;
  }
}

TEST(Coefficients, BadInputIsRefused) {
  Eigen::MatrixXd x = correlated(10, 3);
  EXPECT_THROW(fit_coefficients("MGV", x, {}), UsageError);
  EXPECT_THROW(fit_coefficients("MVG", x.topRows(2), {}), DataError);
  // Fewer samples than dimensions, a dimension that never changes.
  Eigen::MatrixXd wide = correlated(4, 30);
  wide.col(7).setConstant(1);
  for (const std::string& name : coefficient_model_names()) {
    const auto model = fit_coefficients(name, wide, {});
    EXPECT_TRUE(draw(*model, 20).allFinite()) << name;
    EXPECT_TRUE(std::isfinite(model->log_density(wide.row(1).transpose()))) << name;
    EXPECT_LT((draw(*model, 20).col(7).array() - 1).abs().maxCoeff(), 0.01) << name;
  }
  x(2, 2) = std::nan("");
  EXPECT_THROW(fit_coefficients("IG", x, {}), DataError);
}

}  // namespace

}  // namespace mocaplm::coefficients_test
