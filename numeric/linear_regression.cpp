#include "numeric/linear_regression.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/error.h"
#include "common/random.h"
#include "numeric/distributions.h"

namespace mocaplm {

namespace {

constexpr double kTune = 4.685;  // of Tukey's bisquare

// The conditions, centred, scaled to unit variance, and with a column of ones behind them.
struct Design {
  Eigen::MatrixXd z;        // (n, k + 1)
  Eigen::MatrixXd to_z;     // (k + 1, k + 1): [z; 1] = to_z [x; 1]
  Eigen::MatrixXd inverse;  // (k + 1, k + 1): pseudo-inverse of z'z + ridge
  Eigen::Index rank = 0;
};

Design make_design(const Eigen::MatrixXd& x, double ridge) {
  const Eigen::Index n = x.rows(), k = x.cols();
  Design design;
  design.z = Eigen::MatrixXd::Ones(n, k + 1);
  design.to_z = Eigen::MatrixXd::Zero(k + 1, k + 1);
  design.to_z(k, k) = 1;
  for (Eigen::Index j = 0; j < k; ++j) {
    const double mean = x.col(j).mean();
    const double deviation = std::sqrt((x.col(j).array() - mean).square().mean());
    const bool constant = deviation <= 1e-10 * std::abs(mean) || deviation == 0;
    design.to_z(j, j) = constant ? 0 : 1 / deviation;
    design.to_z(j, k) = constant ? 0 : -mean / deviation;
    design.z.col(j) = (x.col(j).array() - mean) * design.to_z(j, j);
  }
  design.inverse = Eigen::MatrixXd::Zero(k + 1, k + 1);
  design.inverse(k, k) = 1 / static_cast<double>(n);
  design.rank = 1;
  if (k == 0) return design;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(design.z.leftCols(k),
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  for (Eigen::Index i = 0; i < svd.singularValues().size(); ++i) {
    const double value = svd.singularValues()(i);
    if (!(value > 1e-9 * std::sqrt(static_cast<double>(n)))) continue;
    ++design.rank;
    const Eigen::VectorXd v = svd.matrixV().col(i);
    design.inverse.topLeftCorner(k, k) +=
        v * v.transpose() / (value * value + ridge * static_cast<double>(n));
  }
  return design;
}

// theta (k + 1) that minimises sum w (y - theta z)^2 + ridge; directions that the rows do not have
// stay 0.
Eigen::VectorXd weighted_fit(const Eigen::MatrixXd& z, const Eigen::VectorXd& y,
                             const Eigen::VectorXd& weights, double ridge) {
  const Eigen::Index k = z.cols() - 1;
  const double total = weights.sum();
  const Eigen::RowVectorXd mean_z = weights.transpose() * z.leftCols(k) / total;
  const double mean_y = weights.dot(y) / total;
  const Eigen::VectorXd root = weights.cwiseSqrt();
  const Eigen::MatrixXd a = root.asDiagonal() * (z.leftCols(k).rowwise() - mean_z);
  const Eigen::VectorXd b = root.asDiagonal() * (y.array() - mean_y).matrix();
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(k + 1);
  if (k > 0) {
    Eigen::MatrixXd gram = a.transpose() * a;
    gram.diagonal().array() += ridge * total;
    // A row's own weight may vanish, so that directions get lost: the same cut as make_design's.
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(gram, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd s = svd.singularValues();
    const Eigen::VectorXd keep =
        (s.array() > 1e-12 * std::max(s(0), total)).select(s.cwiseInverse(), 0);
    theta.head(k) =
        svd.matrixV() * (keep.asDiagonal() * (svd.matrixU().transpose() * (a.transpose() * b)));
  }
  theta(k) = mean_y - mean_z.dot(theta.head(k));
  return theta;
}

std::vector<std::size_t> by_size(const Eigen::VectorXd& residuals) {
  std::vector<std::size_t> order(static_cast<std::size_t>(residuals.size()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(residuals(static_cast<Eigen::Index>(a))) <
           std::abs(residuals(static_cast<Eigen::Index>(b)));
  });
  return order;
}

// Least trimmed squares by concentration steps from random subsets (Rousseeuw and Van Driessen
// 2006, "Computing LTS regression for large data sets").
Eigen::VectorXd least_trimmed_squares(const Eigen::MatrixXd& z, const Eigen::VectorXd& y,
                                      Eigen::Index rank, double ridge) {
  constexpr int kStarts = 60, kSteps = 12;
  const auto n = static_cast<std::size_t>(z.rows()), p = static_cast<std::size_t>(rank);
  const std::size_t half = (n + p + 1) / 2;
  Random random(20);  // a start that is the same for all: a fit repeats
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  for (int start = 0; start < kStarts; ++start) {
    random.shuffle(order);
    std::vector<std::size_t> chosen(order.begin(),
                                    order.begin() + static_cast<std::ptrdiff_t>(p + 1));
    double sum = 0, before = least;
    Eigen::VectorXd theta;
    for (int step = 0; step < kSteps; ++step) {
      Eigen::VectorXd weights = Eigen::VectorXd::Zero(z.rows());
      for (const std::size_t i : chosen) weights(static_cast<Eigen::Index>(i)) = 1;
      theta = weighted_fit(z, y, weights, ridge);
      const Eigen::VectorXd residuals = y - z * theta;
      chosen = by_size(residuals);
      chosen.resize(half);
      sum = 0;
      for (const std::size_t i : chosen)
        sum += std::pow(residuals(static_cast<Eigen::Index>(i)), 2);
      if (step > 1 && sum >= before * (1 - 1e-12)) break;
      before = sum;
    }
    if (sum < least) {
      least = sum;
      best = theta;
    }
  }
  return best;
}

// Rousseeuw and Leroy's first scale of a fit that only looked at half of the rows.
double first_scale(const Eigen::VectorXd& residuals, Eigen::Index rank) {
  const std::vector<std::size_t> order = by_size(residuals);
  const double median = std::abs(residuals(static_cast<Eigen::Index>(order[order.size() / 2])));
  const double free = std::max<double>(1, static_cast<double>(residuals.size() - rank));
  return 1.4826 * (1 + 5 / free) * median;
}

struct RobustFit {
  Eigen::VectorXd theta, weights;
  double scale = 0;
};

// Bisquare weights at a fixed scale, from a start.
void reweight(RobustFit& fit, const Eigen::MatrixXd& z, const Eigen::VectorXd& y, double ridge) {
  const double tiny = 1e-9 * std::sqrt((y.array() - y.mean()).square().mean());
  for (int i = 0; i < 50; ++i) {
    const Eigen::ArrayXd residuals = (y - z * fit.theta).array().abs();
    if (fit.scale <= tiny) {  // half of the rows or more are met exactly
      fit.weights = (residuals <= tiny).select(Eigen::ArrayXd::Ones(y.size()), 0);
    } else {
      const Eigen::ArrayXd u = residuals / (kTune * fit.scale);
      fit.weights = (u < 1).select((1 - u.square()).square(), 0);
    }
    const Eigen::VectorXd theta = weighted_fit(z, y, fit.weights, ridge);
    const double change = (z * (theta - fit.theta)).cwiseAbs().maxCoeff();
    fit.theta = theta;
    if (change <= 1e-10 * std::max(fit.scale, tiny)) break;
  }
}

RobustFit robust_fit(const Eigen::MatrixXd& z, const Eigen::VectorXd& y, Eigen::Index rank,
                     double ridge) {
  RobustFit fit;
  fit.theta = least_trimmed_squares(z, y, rank, ridge);
  fit.scale = first_scale(y - z * fit.theta, rank);
  reweight(fit, z, y, ridge);
  return fit;
}

void check(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  assert(x.rows() == y.rows());
  if (!x.allFinite() || !y.allFinite())
    throw DataError(in_file("regression"), "a value is not a finite number");
}

}  // namespace

Eigen::MatrixXd LinearRegression::covariance() const {
  Eigen::MatrixXd e = residuals;
  if ((weights.array() < 1).any())
    for (Eigen::Index j = 0; j < e.cols(); ++j) {
      // psi and its mean slope (Huber 1981, 7.6): w = (1 - u^2)^2, psi' = (1 - u^2)(1 - 5 u^2).
      const Eigen::ArrayXd root = weights.col(j).array().sqrt();
      const double slope = (root * (5 * root - 4)).mean();
      e.col(j).array() *= weights.col(j).array() / std::max(slope, 0.1);
    }
  return e.transpose() * e / static_cast<double>(std::max<Eigen::Index>(1, dof()));
}

LinearRegression fit_linear(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                            const RegressionOptions& options) {
  check(x, y);
  const Design design = make_design(x, options.ridge);
  if (x.rows() < design.rank + 1)
    throw DataError(in_file("regression"), std::to_string(x.rows()) + " rows for " +
                                               std::to_string(design.rank) +
                                               " unknowns; more rows than unknowns are needed");
  LinearRegression fit;
  fit.rank = design.rank;
  fit.ridge = options.ridge;
  fit.gram_inverse = design.to_z.transpose() * design.inverse * design.to_z;
  fit.leverage = (design.z * design.inverse).cwiseProduct(design.z).rowwise().sum();
  fit.weights = Eigen::MatrixXd::Ones(y.rows(), y.cols());
  Eigen::MatrixXd theta(y.cols(), x.cols() + 1);
  if (options.robust) {
    for (Eigen::Index j = 0; j < y.cols(); ++j) {
      const RobustFit one = robust_fit(design.z, y.col(j), design.rank, options.ridge);
      theta.row(j) = one.theta;
      fit.weights.col(j) = one.weights;
    }
  } else {
    const Eigen::RowVectorXd mean = y.colwise().mean();
    theta = ((y.rowwise() - mean).transpose() * design.z) * design.inverse;
    theta.col(x.cols()) = mean.transpose();
  }
  fit.f = theta * design.to_z;
  fit.residuals = y - design.z * theta.transpose();
  return fit;
}

ResponseStatistics response_statistics(const LinearRegression& fit, const Eigen::MatrixXd& x,
                                       const Eigen::MatrixXd& y, Eigen::Index response) {
  assert(fit.ridge == 0 && (fit.weights.array() == 1).all());
  const Eigen::Index n = y.rows(), k = x.cols();
  const auto count = static_cast<double>(n);
  const Eigen::VectorXd e = fit.residuals.col(response);
  const double mean = y.col(response).mean();
  const double total = (y.col(response).array() - mean).square().sum();
  const double left = e.squaredNorm(), size = y.col(response).squaredNorm();
  const auto free = static_cast<double>(fit.dof()), used = static_cast<double>(fit.rank - 1);
  const bool constant = total <= 1e-24 * (size + 1e-300), exact = left <= 1e-20 * total;

  ResponseStatistics out;
  out.half_width = Eigen::VectorXd::Zero(k + 1);
  out.jackknife_variance = Eigen::VectorXd::Zero(k + 1);
  if (constant) return out;
  out.r_squared = exact ? 1 : 1 - left / total;
  out.left_out_r_squared = out.r_squared;
  if (used > 0) {
    out.f = exact ? std::numeric_limits<double>::infinity() : (total - left) / used / (left / free);
    out.f_p = f_tail(out.f, used, free);
  }
  if (exact) return out;
  out.half_width = t_quantile(0.975, free) * std::sqrt(left / free) *
                   fit.gram_inverse.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd one_out = e.array() / (1 - fit.leverage.array()).max(1e-12);
  out.left_out_r_squared = 1 - one_out.squaredNorm() / total;
  Eigen::MatrixXd conditions(n, k + 1);
  conditions << x, Eigen::VectorXd::Ones(n);
  // The fit without row i is f - gram_inverse [x_i; 1] e_i / (1 - h_i) (Miller 1974).
  const Eigen::MatrixXd change = one_out.asDiagonal() * (conditions * fit.gram_inverse);
  out.jackknife_variance =
      (change.rowwise() - change.colwise().mean()).colwise().squaredNorm().transpose() *
      (count - 1) / count;
  return out;
}

Eigen::MatrixXd left_out_predictions(const LinearRegression& fit, const Eigen::MatrixXd& x,
                                     const Eigen::MatrixXd& y, const RegressionOptions& options) {
  if (!options.robust) {
    const Eigen::ArrayXd rest = (1 - fit.leverage.array()).max(1e-12);
    return y - (fit.residuals.array().colwise() / rest).matrix();
  }
  const Design design = make_design(x, options.ridge);
  Eigen::MatrixXd predictions(y.rows(), y.cols());
  for (Eigen::Index i = 0; i < y.rows(); ++i) {
    Eigen::MatrixXd others_z(y.rows() - 1, design.z.cols());
    others_z << design.z.topRows(i), design.z.bottomRows(y.rows() - 1 - i);
    for (Eigen::Index j = 0; j < y.cols(); ++j) {
      Eigen::VectorXd others(y.rows() - 1);
      others << y.col(j).head(i), y.col(j).tail(y.rows() - 1 - i);
      // From the fit of all, with its weights: a new search from random subsets for each row
      // would take seconds and give the same.
      RobustFit one;
      Eigen::VectorXd weights(others.size());
      weights << fit.weights.col(j).head(i), fit.weights.col(j).tail(y.rows() - 1 - i);
      one.theta = weighted_fit(others_z, others, weights.cwiseMax(1e-12), options.ridge);
      one.scale = first_scale(others - others_z * one.theta, fit.rank);
      reweight(one, others_z, others, options.ridge);
      predictions(i, j) = design.z.row(i).dot(one.theta);
    }
  }
  return predictions;
}

}  // namespace mocaplm
