// Distributions of the coefficients of motions (section 4.3), few samples of many dimensions.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "common/json.h"
#include "common/random.h"
#include "emulator/scheme.h"

namespace mocaplm {

class CoefficientModel {
 public:
  virtual ~CoefficientModel() = default;
  virtual Eigen::Index dimensions() const = 0;
  // (count, d). Each row is distributed as the model; together they may be stratified (below).
  virtual Eigen::MatrixXd sample(Eigen::Index count, Random& random) const = 0;
  // Natural logarithm of the density.
  virtual double log_density(const Eigen::VectorXd& x) const = 0;
  virtual Json json() const = 0;
};

//   IG         independent Gaussians
//   MVG        one Gaussian, its covariance shrunk (shrunk_covariance)
//   Copula     Gaussian copula of the shrunk correlation of normal scores; marginals smoothed by a
//              Gaussian kernel that keeps their variance
//   Mixture    Gaussians of one shared shrunk covariance (fit_gaussians in emulator/gaussians.h);
//              how many by five-fold cross-validated likelihood
//   Bootstrap  the smoothed bootstrap with the variance kept (Silverman 1986, 6.4.1): a sample of
//              the data, moved by a kernel of the shrunk covariance, drawn together so that
//              the whole has the data's mean and covariance; the bandwidth by the likelihood of
//              each sample under the others
//   Local      a kernel on each sample, shaped as its neighbours lie ("manifold Parzen windows",
//              Vincent and Bengio 2003), the variance kept (emulator/local.h)
//
// Models of several Gaussians or kernels draw them stratified, unless the options say otherwise:
// of `count` samples each kernel makes its share, rounded up or down by chance (systematic
// sampling; Madow and Madow 1944). Independent draws would add their own chance to that of the
// data.
//
// samples (M, d), M >= 3. Throws DataError for values that are not finite.
std::unique_ptr<CoefficientModel> fit_coefficients(const std::string& name,
                                                   const Eigen::MatrixXd& samples,
                                                   const SchemeOptions& options);
// Throws DataError naming the key.
std::unique_ptr<CoefficientModel> read_coefficients(const Json& json, const std::string& place);

const std::vector<std::string>& coefficient_model_names();

// The covariance (divisor M - 1) with its correlations shrunk by `shrinkage` in [0, 1], or, at -1,
// by the share that minimises the expected squared error, estimated from the data (Schaefer and
// Strimmer 2005, target D). Variances below 1e-10 of the largest are raised to that: components
// that do not vary. `used` receives the share.
Eigen::MatrixXd shrunk_covariance(const Eigen::MatrixXd& samples, double shrinkage,
                                  double* used = nullptr);

// `count` draws of an index with these weights (which add up to 1), in random order: stratified, or
// independent.
std::vector<Eigen::Index> draw_indices(const Eigen::VectorXd& weights, Eigen::Index count,
                                       bool stratified, Random& random);

}  // namespace mocaplm
