// A kernel on every sample, shaped as the samples near it lie (Vincent and Bengio 2003, "Manifold
// Parzen windows"), which keeps the variance as the smoothed bootstrap does (Silverman
// 1986, 6.4.1).
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "emulator/coefficients.h"

namespace mocaplm {

//   x = mean + r (c_i - c + s (sqrt((1 - w) / k) sum_j z_j (x_j - m_i) + sqrt(w) e)),
//   c_i = m_i + sqrt(1 - s^2) (x_i - m_i)
// j over sample i and its k nearest, m_i the mean of these k + 1, z_j standard normal, e ~ N(0, D),
// D the mean variances of all neighbourhoods, c the mean of all c_i. So nothing is far from all
// samples, and what is made lies between a sample and those like it: the styles and persons that
// one Gaussian would mix stay apart. s is the spread; w the floor: k + 1 samples span few
// dimensions, and their covariance is shrunk towards a diagonal by that share.
//
// A kernel put on the sample itself would add its variance to that of the samples. Here the sample
// first moves towards its neighbours by as much: a neighbourhood keeps its variances. What is left
// to add (neighbours of another kind) is taken back by r, one number a coefficient, so that mean
// and variances of the whole are those of the samples, exactly.
class LocalKernels : public CoefficientModel {
 public:
  // samples (M, d), M >= 2; neighbours (M, k) rows of indices; spread and floor in (0, 1].
  LocalKernels(Eigen::MatrixXd samples, Eigen::MatrixXi neighbours, double spread, double floor,
               bool stratified);

  Eigen::Index dimensions() const override { return samples_.cols(); }
  Eigen::MatrixXd sample(Eigen::Index count, Random& random) const override;
  double log_density(const Eigen::VectorXd& x) const override;
  Json json() const override;
  static std::unique_ptr<LocalKernels> read(JsonObject& object);

 private:
  // In units of noise_: x ~ N(centre, I + ways ways').
  struct Kernel {
    Eigen::VectorXd centre;             // (d)
    Eigen::MatrixXd ways;               // (d, k + 1)
    Eigen::LLT<Eigen::MatrixXd> inner;  // I + ways' ways, which has the same determinant
  };
  void place_kernels();

  Eigen::MatrixXd samples_;
  Eigen::MatrixXi neighbours_;
  double spread_, floor_;
  bool stratified_;
  Eigen::VectorXd noise_;  // (d): r s sqrt(w) times the roots of D
  std::vector<Kernel> kernels_;
};

// Nearest by Euclidean distance; k is lowered to M - 1.
std::unique_ptr<LocalKernels> fit_local(const Eigen::MatrixXd& samples,
                                        const SchemeOptions& options);

}  // namespace mocaplm
