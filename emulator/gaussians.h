// A mixture of Gaussians that share a covariance: one Gaussian, a mixture proper, and a kernel on
// every sample are all of this form.
#pragma once

#include "emulator/coefficients.h"

namespace mocaplm {

class Gaussians : public CoefficientModel {
 public:
  // weights (K) add up to 1; means (K, d); covariance (d, d), positive definite.
  Gaussians(Eigen::VectorXd weights, Eigen::MatrixXd means, const Eigen::MatrixXd& covariance,
            bool stratified = true);

  Eigen::Index dimensions() const override { return means_.cols(); }
  Eigen::MatrixXd sample(Eigen::Index count, Random& random) const override;
  double log_density(const Eigen::VectorXd& x) const override;
  Json json() const override;
  static std::unique_ptr<Gaussians> read(JsonObject& object);

  Eigen::Index count() const { return weights_.size(); }
  const Eigen::VectorXd& weights() const { return weights_; }
  const Eigen::MatrixXd& means() const { return means_; }
  // (K) log(weight * density) of each.
  Eigen::VectorXd log_parts(const Eigen::VectorXd& x) const;

 private:
  Eigen::VectorXd weights_;
  Eigen::MatrixXd means_;
  Eigen::MatrixXd factor_;  // (d, d) lower: covariance = factor factor'
  double log_norm_ = 0;
  bool stratified_;
};

// log(sum exp(x)), without overflow.
double log_sum_exp(const Eigen::VectorXd& x);

// By classification expectation maximisation (Celeux and Govaert 1992: each sample belongs to its
// likeliest Gaussian) from k-means (seeded, the best of 5 starts); the shared covariance is shrunk
// as shrunk_covariance does at each step. 1 <= count <= M. A Gaussian that loses all
// samples is left out.
std::unique_ptr<Gaussians> fit_gaussians(const Eigen::MatrixXd& samples, Eigen::Index count,
                                         double shrinkage, bool stratified = true);
// The number of Gaussians, up to `most`, of the largest five-fold cross-validated likelihood.
Eigen::Index choose_gaussians(const Eigen::MatrixXd& samples, Eigen::Index most, double shrinkage);

// Silverman's smoothed bootstrap; `bandwidth` in units of his rule for d dimensions, 0: chosen.
std::unique_ptr<Gaussians> fit_bootstrap(const Eigen::MatrixXd& samples, double shrinkage,
                                         double bandwidth, bool stratified = true,
                                         double* used = nullptr);

}  // namespace mocaplm
