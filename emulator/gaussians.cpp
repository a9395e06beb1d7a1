#include "emulator/gaussians.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/angles.h"
#include "common/error.h"
#include "emulator/reduction.h"

namespace mocaplm {

double log_sum_exp(const Eigen::VectorXd& x) {
  const double most = x.maxCoeff();
  return std::isfinite(most) ? most + std::log((x.array() - most).exp().sum()) : most;
}

Gaussians::Gaussians(Eigen::VectorXd weights, Eigen::MatrixXd means,
                     const Eigen::MatrixXd& covariance, bool stratified)
    : weights_(std::move(weights)), means_(std::move(means)), stratified_(stratified) {
  const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
  if (llt.info() != Eigen::Success)
    throw DataError(in_file("coefficients"), "their covariance is not positive definite");
  factor_ = llt.matrixL();
  log_norm_ = -factor_.diagonal().array().log().sum() -
              0.5 * static_cast<double>(means_.cols()) * std::log(2 * kPi);
}

Eigen::MatrixXd Gaussians::sample(Eigen::Index count, Random& random) const {
  Eigen::MatrixXd drawn(count, dimensions());
  const std::vector<Eigen::Index> which = draw_indices(weights_, count, stratified_, random);
  Eigen::VectorXd z(dimensions());
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = random.normal();
    drawn.row(k) = means_.row(which[static_cast<std::size_t>(k)]) +
                   (factor_.triangularView<Eigen::Lower>() * z).transpose();
  }
  return drawn;
}

Eigen::VectorXd Gaussians::log_parts(const Eigen::VectorXd& x) const {
  Eigen::MatrixXd away = (-means_.transpose()).colwise() + x;  // (d, K)
  factor_.triangularView<Eigen::Lower>().solveInPlace(away);
  return weights_.array().log() + log_norm_ -
         0.5 * away.colwise().squaredNorm().transpose().array();
}

double Gaussians::log_density(const Eigen::VectorXd& x) const {
  return log_sum_exp(log_parts(x));
}

Json Gaussians::json() const {
  return {{"model", "Gaussians"},
          {"stratified", stratified_},
          {"weights", matrix_json(weights_)},
          {"means", matrix_json(means_)},
          {"factor", matrix_json(factor_)}};
}

std::unique_ptr<Gaussians> Gaussians::read(JsonObject& object) {
  const Eigen::MatrixXd weights = read_matrix(object, "weights", -1, 1);
  Eigen::MatrixXd means = read_matrix(object, "means", weights.rows(), -1);
  Eigen::MatrixXd factor = read_matrix(object, "factor", means.cols(), means.cols());
  if (weights.minCoeff() < 0 || std::abs(weights.sum() - 1) > 1e-6)
    object.fail("weights", "expected shares that add up to 1");
  if (factor.diagonal().minCoeff() <= 0) object.fail("factor", "expected a positive diagonal");
  factor = Eigen::MatrixXd(factor.triangularView<Eigen::Lower>());
  return std::make_unique<Gaussians>(weights.col(0), std::move(means), factor * factor.transpose(),
                                     object.boolean("stratified"));
}

namespace {

struct Clusters {
  std::vector<Eigen::Index> of;  // each sample's
  double cost = std::numeric_limits<double>::infinity();
};

// Lloyd's k-means from k-means++ (Arthur and Vassilvitskii 2007).
Clusters k_means(const Eigen::MatrixXd& x, Eigen::Index count, Random& random) {
  const Eigen::Index m = x.rows();
  Eigen::MatrixXd centres(count, x.cols());
  centres.row(0) = x.row(static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(m))));
  Eigen::VectorXd near = Eigen::VectorXd::Constant(m, std::numeric_limits<double>::infinity());
  for (Eigen::Index k = 1; k < count; ++k) {
    near = near.cwiseMin((x.rowwise() - centres.row(k - 1)).rowwise().squaredNorm());
    double at = random.uniform() * near.sum();
    Eigen::Index chosen = 0;
    while (chosen + 1 < m && at >= near[chosen]) at -= near[chosen++];
    centres.row(k) = x.row(chosen);
  }
  Clusters clusters;
  clusters.of.assign(static_cast<std::size_t>(m), 0);
  for (int round = 0; round < 100; ++round) {
    double cost = 0;
    for (Eigen::Index i = 0; i < m; ++i)
      cost += (centres.rowwise() - x.row(i))
                  .rowwise()
                  .squaredNorm()
                  .minCoeff(&clusters.of[static_cast<std::size_t>(i)]);
    if (cost >= clusters.cost) break;
    clusters.cost = cost;
    for (Eigen::Index k = 0; k < count; ++k) {
      Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(x.cols());
      double n = 0;
      for (Eigen::Index i = 0; i < m; ++i)
        if (clusters.of[static_cast<std::size_t>(i)] == k) {
          sum += x.row(i);
          ++n;
        }
      if (n > 0) centres.row(k) = sum / n;
    }
  }
  return clusters;
}

// One maximisation: shares (M, K), 1 where a sample belongs to a Gaussian, else 0.
std::unique_ptr<Gaussians> maximise(const Eigen::MatrixXd& x, const Eigen::MatrixXd& shares,
                                    double shrinkage, bool stratified) {
  const Eigen::Index m = x.rows();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < shares.cols(); ++k)
    if (shares.col(k).sum() > 0) kept.push_back(k);
  const auto count = static_cast<Eigen::Index>(kept.size());
  Eigen::VectorXd weights(count);
  Eigen::MatrixXd means(count, x.cols()), away = x;
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto share = shares.col(kept[static_cast<std::size_t>(k)]);
    weights[k] = share.sum();
    means.row(k) = share.transpose() * x / weights[k];
    away -= share * means.row(k);
  }
  // The means have taken `count` of the freedoms.
  const double freedom =
      static_cast<double>(m - 1) / static_cast<double>(std::max<Eigen::Index>(m - count, 1));
  weights /= weights.sum();
  return std::make_unique<Gaussians>(weights, means, freedom * shrunk_covariance(away, shrinkage),
                                     stratified);
}

}  // namespace

std::unique_ptr<Gaussians> fit_gaussians(const Eigen::MatrixXd& samples, Eigen::Index count,
                                         double shrinkage, bool stratified) {
  const Eigen::Index m = samples.rows();
  Random random(1);
  Clusters best;
  for (int start = 0; start < 5; ++start) {
    Clusters clusters = k_means(samples, std::min(count, m), random);
    if (clusters.cost < best.cost) best = std::move(clusters);
  }
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(m, std::min(count, m));
  for (Eigen::Index i = 0; i < m; ++i) shares(i, best.of[static_cast<std::size_t>(i)]) = 1;
  std::unique_ptr<Gaussians> model = maximise(samples, shares, shrinkage, stratified);
  double last = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < 50 && model->count() > 1; ++round) {
    shares.setZero(m, model->count());
    double likelihood = 0;
    for (Eigen::Index i = 0; i < m; ++i) {
      Eigen::Index k = 0;
      likelihood += model->log_parts(samples.row(i).transpose()).maxCoeff(&k);
      shares(i, k) = 1;
    }
    if (likelihood < last + 1e-6 * std::abs(last)) break;
    last = likelihood;
    model = maximise(samples, shares, shrinkage, stratified);
  }
  return model;
}

Eigen::Index choose_gaussians(const Eigen::MatrixXd& samples, Eigen::Index most, double shrinkage) {
  const Eigen::Index m = samples.rows(), folds = std::min<Eigen::Index>(5, m);
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < m; ++i) order.push_back(i);
  Random random(2);
  random.shuffle(order);
  Eigen::Index best = 1;
  double largest = -std::numeric_limits<double>::infinity();
  for (Eigen::Index count = 1; count <= std::min(most, m * (folds - 1) / folds / 3); ++count) {
    double likelihood = 0;
    for (Eigen::Index fold = 0; fold < folds; ++fold) {
      Eigen::MatrixXd train(m - (m - fold + folds - 1) / folds, samples.cols());
      Eigen::Index at = 0;
      for (Eigen::Index i = 0; i < m; ++i)
        if (i % folds != fold) train.row(at++) = samples.row(order[static_cast<std::size_t>(i)]);
      const auto model = fit_gaussians(train, count, shrinkage);
      for (Eigen::Index i = fold; i < m; i += folds)
        likelihood +=
            model->log_density(samples.row(order[static_cast<std::size_t>(i)]).transpose());
    }
    if (likelihood > largest) {
      largest = likelihood;
      best = count;
    }
  }
  return best;
}

namespace {

// The log likelihood of each sample under the kernels on all others; white (M, d): the samples
// about their mean in units of the covariance.
double left_out_likelihood(const Eigen::MatrixXd& white, double h) {
  const Eigen::Index m = white.rows();
  const double together = 1 / std::sqrt(1 + h * h), width = h * together;
  double sum = 0;
  for (Eigen::Index i = 0; i < m; ++i) {
    Eigen::VectorXd parts = -0.5 / (width * width) *
                            ((-together * white).rowwise() + white.row(i)).rowwise().squaredNorm();
    parts[i] = -std::numeric_limits<double>::infinity();
    sum += log_sum_exp(parts) - static_cast<double>(white.cols()) * std::log(width);
  }
  return sum;
}

}  // namespace

std::unique_ptr<Gaussians> fit_bootstrap(const Eigen::MatrixXd& samples, double shrinkage,
                                         double bandwidth, bool stratified, double* used) {
  const Eigen::Index m = samples.rows(), d = samples.cols();
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const Eigen::MatrixXd centred = samples.rowwise() - mean;
  const Eigen::MatrixXd covariance = shrunk_covariance(samples, shrinkage);
  const double rule = std::pow(4 / ((static_cast<double>(d) + 2) * static_cast<double>(m)),
                               1 / (static_cast<double>(d) + 4));
  double h = bandwidth * rule;
  if (bandwidth <= 0) {
    const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
    Eigen::MatrixXd white = llt.matrixL().solve(centred.transpose());
    white.transposeInPlace();
    double largest = -std::numeric_limits<double>::infinity();
    for (double trial = 0.05; trial < 3; trial *= 1.1) {
      const double likelihood = left_out_likelihood(white, trial);
      if (likelihood > largest) {
        largest = likelihood;
        h = trial;
      }
    }
  }
  if (used != nullptr) *used = h / rule;
  const double together = 1 / std::sqrt(1 + h * h);
  return std::make_unique<Gaussians>(Eigen::VectorXd::Constant(m, 1 / static_cast<double>(m)),
                                     (together * centred).rowwise() + mean,
                                     h * h * together * together * covariance, stratified);
}

}  // namespace mocaplm
