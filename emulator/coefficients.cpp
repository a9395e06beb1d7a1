#include "emulator/coefficients.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/text.h"
#include "emulator/gaussians.h"
#include "emulator/local.h"
#include "emulator/reduction.h"
#include "numeric/distributions.h"
#include "numeric/quantiles.h"

namespace mocaplm {

Eigen::MatrixXd shrunk_covariance(const Eigen::MatrixXd& samples, double shrinkage, double* used) {
  const Eigen::Index d = samples.cols();
  const double n = static_cast<double>(samples.rows());
  const Eigen::MatrixXd centred = samples.rowwise() - samples.colwise().mean();
  Eigen::VectorXd variance = centred.colwise().squaredNorm().transpose() / (n - 1);
  const double floor = std::max(1e-10 * variance.maxCoeff(), 1e-300);
  const Eigen::MatrixXd z =
      centred * variance.cwiseMax(floor).cwiseSqrt().cwiseInverse().asDiagonal();
  variance = variance.cwiseMax(floor);
  const Eigen::MatrixXd mean_product = z.transpose() * z / n;
  const Eigen::MatrixXd squares = z.array().square().matrix();
  double share = shrinkage;
  if (shrinkage < 0) {
    // Var(r_ij) = n / (n - 1)^3 sum_k (z_ki z_kj - mean)^2, summed over i != j.
    const Eigen::MatrixXd spread =
        n / std::pow(n - 1, 3) *
        (squares.transpose() * squares - n * mean_product.array().square().matrix());
    const Eigen::MatrixXd r2 = (n / (n - 1) * mean_product).array().square().matrix();
    const double above = spread.sum() - spread.trace(), below = r2.sum() - r2.trace();
    share = d > 1 && below > 0 ? std::min(1.0, std::max(0.0, above / below)) : 1;
    // A covariance of fewer samples than dimensions has no inverse.
    if (n - 1 < static_cast<double>(d)) share = std::max(share, 1e-3);
  }
  if (used != nullptr) *used = share;
  Eigen::MatrixXd correlation = (1 - share) * n / (n - 1) * mean_product;
  // A little on the diagonal keeps what repeats itself invertible.
  correlation.diagonal().setConstant(1 + 1e-9);
  const Eigen::VectorXd deviation = variance.cwiseSqrt();
  return deviation.asDiagonal() * correlation * deviation.asDiagonal();
}

std::vector<Eigen::Index> draw_indices(const Eigen::VectorXd& weights, Eigen::Index count,
                                       bool stratified, Random& random) {
  // Weights in random order, so that no two kernels are always drawn together.
  std::vector<Eigen::Index> order, drawn;
  for (Eigen::Index k = 0; k < weights.size(); ++k) order.push_back(k);
  random.shuffle(order);
  const double start = random.uniform();
  for (Eigen::Index n = 0; n < count; ++n) {
    double at = stratified ? (start + static_cast<double>(n)) / static_cast<double>(count)
                           : random.uniform();
    std::size_t k = 0;
    while (k + 1 < order.size() && at >= weights[order[k]]) at -= weights[order[k++]];
    drawn.push_back(order[k]);
  }
  random.shuffle(drawn);
  return drawn;
}

namespace {

// One coefficient's distribution: kernels of one width on points drawn together about their mean.
struct Marginal {
  Eigen::VectorXd points;
  double width = 1;

  double cdf(double x) const {
    double sum = 0;
    for (const double point : points) sum += normal_cdf((x - point) / width);
    return sum / static_cast<double>(points.size());
  }
  double log_density(double x) const {
    return log_sum_exp(-0.5 * ((points.array() - x) / width).square()) -
           std::log(width * static_cast<double>(points.size()) * std::sqrt(2 * kPi));
  }
  // By Newton's steps, halving the interval where one leads out of it.
  double quantile(double p) const {
    double low = points.minCoeff() - 12 * width, high = points.maxCoeff() + 12 * width;
    double x = 0.5 * (low + high), last = high - low;
    for (int round = 0; round < 200 && last > 1e-13 * width; ++round) {
      const double off = cdf(x) - p;
      (off < 0 ? low : high) = x;
      const double step = off / std::exp(log_density(x));
      const bool good = x - step > low && x - step < high && std::abs(step) < 0.5 * last;
      last = good ? std::abs(step) : 0.5 * (high - low);
      x = good ? x - step : 0.5 * (low + high);
    }
    return x;
  }
};

Marginal fit_marginal(const Eigen::VectorXd& x, double bandwidth) {
  const double n = static_cast<double>(x.size());
  const double mean = x.mean();
  const double deviation = std::sqrt((x.array() - mean).square().sum() / (n - 1));
  std::vector<double> sorted(x.data(), x.data() + x.size());
  std::sort(sorted.begin(), sorted.end());
  const double quartiles = sorted[sorted.size() * 3 / 4] - sorted[sorted.size() / 4];
  // Silverman's rule of thumb (1986, 3.31).
  const double scale = quartiles > 0 ? std::min(deviation, quartiles / 1.34) : deviation;
  const double h = std::max((bandwidth > 0 ? bandwidth : 1) * 0.9 * scale * std::pow(n, -0.2),
                            1e-9 * std::max(1.0, std::abs(mean)));
  const double together = deviation > 0 ? 1 / std::sqrt(1 + h * h / (deviation * deviation)) : 1;
  return {(x.array() - mean) * together + mean, h * together};
}

class Copula : public CoefficientModel {
 public:
  Copula(std::vector<Marginal> marginals, const Eigen::MatrixXd& correlation)
      : marginals_(std::move(marginals)), factor_(correlation.llt().matrixL()) {}

  Eigen::Index dimensions() const override { return factor_.rows(); }

  Eigen::MatrixXd sample(Eigen::Index count, Random& random) const override {
    Eigen::MatrixXd drawn(count, dimensions());
    Eigen::VectorXd z(dimensions());
    for (Eigen::Index k = 0; k < count; ++k) {
      for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = random.normal();
      z = factor_.triangularView<Eigen::Lower>() * z;
      for (Eigen::Index i = 0; i < z.size(); ++i)
        drawn(k, i) = marginals_[static_cast<std::size_t>(i)].quantile(normal_cdf(z[i]));
    }
    return drawn;
  }

  double log_density(const Eigen::VectorXd& x) const override {
    Eigen::VectorXd z(x.size());
    double sum = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const Marginal& marginal = marginals_[static_cast<std::size_t>(i)];
      sum += marginal.log_density(x[i]);
      // Beyond this the quantile has no digits left.
      z[i] = normal_quantile(std::min(1 - 1e-15, std::max(1e-15, marginal.cdf(x[i]))));
    }
    sum += 0.5 * z.squaredNorm() - factor_.diagonal().array().log().sum();
    factor_.triangularView<Eigen::Lower>().solveInPlace(z);
    return sum - 0.5 * z.squaredNorm();
  }

  Json json() const override {
    Eigen::MatrixXd points(marginals_[0].points.size(), dimensions());
    Eigen::VectorXd widths(dimensions());
    for (Eigen::Index i = 0; i < dimensions(); ++i) {
      points.col(i) = marginals_[static_cast<std::size_t>(i)].points;
      widths[i] = marginals_[static_cast<std::size_t>(i)].width;
    }
    return {{"model", "Copula"},
            {"points", matrix_json(points)},
            {"widths", matrix_json(widths)},
            {"factor", matrix_json(factor_)}};
  }

  static std::unique_ptr<Copula> read(JsonObject& object) {
    const Eigen::MatrixXd points = read_matrix(object, "points", -1, -1);
    const Eigen::MatrixXd widths = read_matrix(object, "widths", points.cols(), 1);
    Eigen::MatrixXd factor = read_matrix(object, "factor", points.cols(), points.cols());
    if (widths.minCoeff() <= 0) object.fail("widths", "expected positive numbers");
    if (factor.diagonal().minCoeff() <= 0) object.fail("factor", "expected a positive diagonal");
    std::vector<Marginal> marginals;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      marginals.push_back({points.col(i), widths(i, 0)});
    factor = Eigen::MatrixXd(factor.triangularView<Eigen::Lower>());
    return std::make_unique<Copula>(std::move(marginals), factor * factor.transpose());
  }

 private:
  std::vector<Marginal> marginals_;
  Eigen::MatrixXd factor_;  // (d, d) lower, of the correlation
};

std::unique_ptr<CoefficientModel> fit_copula(const Eigen::MatrixXd& samples,
                                             const SchemeOptions& options) {
  std::vector<Marginal> marginals;
  Eigen::MatrixXd scores(samples.rows(), samples.cols());
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    marginals.push_back(fit_marginal(samples.col(i), options.bandwidth));
    for (Eigen::Index k = 0; k < samples.rows(); ++k)
      scores(k, i) = normal_quantile(
          std::min(1 - 1e-15, std::max(1e-15, marginals.back().cdf(samples(k, i)))));
  }
  const Eigen::MatrixXd covariance = shrunk_covariance(scores, options.shrinkage);
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return std::make_unique<Copula>(std::move(marginals),
                                  scale.asDiagonal() * covariance * scale.asDiagonal());
}

}  // namespace

const std::vector<std::string>& coefficient_model_names() {
  static const std::vector<std::string> names = {"IG",      "MVG",       "Copula",
                                                 "Mixture", "Bootstrap", "Local"};
  return names;
}

std::unique_ptr<CoefficientModel> fit_coefficients(const std::string& name,
                                                   const Eigen::MatrixXd& samples,
                                                   const SchemeOptions& options) {
  if (samples.rows() < 3)
    throw DataError(in_file("coefficients"),
                    std::to_string(samples.rows()) + " samples; a distribution needs 3 or more");
  if (!samples.allFinite())
    throw DataError(in_file("coefficients"), "the values are not all finite");
  if (name == "IG" || name == "MVG") {
    const double share = name == "IG" ? 1 : options.shrinkage;
    return std::make_unique<Gaussians>(Eigen::VectorXd::Ones(1), samples.colwise().mean(),
                                       shrunk_covariance(samples, share));
  }
  if (name == "Copula") return fit_copula(samples, options);
  if (name == "Mixture")
    return fit_gaussians(
        samples,
        options.mixture > 0 ? options.mixture : choose_gaussians(samples, 12, options.shrinkage),
        options.shrinkage, options.stratified);
  if (name == "Bootstrap")
    return fit_bootstrap(samples, options.shrinkage, options.bandwidth, options.stratified);
  if (name == "Local") return fit_local(samples, options);
  throw UsageError("unknown model \"" + name + "\"" + known_names(name, coefficient_model_names()));
}

std::unique_ptr<CoefficientModel> read_coefficients(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  const std::string name = object.choice("model", {"Gaussians", "Copula", "Local"});
  std::unique_ptr<CoefficientModel> model;
  if (name == "Copula")
    model = Copula::read(object);
  else if (name == "Local")
    model = LocalKernels::read(object);
  else
    model = Gaussians::read(object);
  object.finish();
  return model;
}

}  // namespace mocaplm
