// A kernel on every sample, shaped as the samples near it lie (Vincent and Bengio 2003, "Manifold
// Parzen windows").
#pragma once

#include "emulator/coefficients.h"

namespace mocaplm {

//   x = x_i + (s / sqrt(k)) sum_j z_j (x_j - x_i) + f e,    j the k nearest samples to x_i,
// z_j standard normal, e ~ N(0, D), D the variances of all samples. So nothing is far from all
// samples, and what is made lies between a sample and those like it: the styles and persons that
// one Gaussian would mix stay apart.
class LocalKernels : public CoefficientModel {
 public:
  // samples (M, d); neighbours (M, k) rows of indices; deviations (d), the roots of D.
  LocalKernels(Eigen::MatrixXd samples, Eigen::MatrixXi neighbours, Eigen::VectorXd deviations,
               double spread, double floor, bool stratified);

  Eigen::Index dimensions() const override { return samples_.cols(); }
  Eigen::MatrixXd sample(Eigen::Index count, Random& random) const override;
  double log_density(const Eigen::VectorXd& x) const override;
  Json json() const override;
  static std::unique_ptr<LocalKernels> read(JsonObject& object);

 private:
  Eigen::MatrixXd samples_;
  Eigen::MatrixXi neighbours_;
  Eigen::VectorXd deviations_;
  double spread_, floor_;
  bool stratified_;
  Eigen::MatrixXd white_;  // (d, M): the samples in units of D
};

// Nearest by Euclidean distance; k is lowered to M - 1.
std::unique_ptr<LocalKernels> fit_local(const Eigen::MatrixXd& samples,
                                        const SchemeOptions& options);

}  // namespace mocaplm
