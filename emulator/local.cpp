#include "emulator/local.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "emulator/gaussians.h"
#include "emulator/reduction.h"

namespace mocaplm {

namespace {

// What never varies still needs a density.
Eigen::VectorXd at_least(const Eigen::VectorXd& variances, double most) {
  return variances.cwiseMax(std::max(1e-10 * most, 1e-290));
}

Eigen::VectorXd variances_of(const Eigen::MatrixXd& samples) {
  const Eigen::MatrixXd centred = samples.rowwise() - samples.colwise().mean();
  const Eigen::VectorXd variances =
      centred.colwise().squaredNorm().transpose() / static_cast<double>(samples.rows() - 1);
  return at_least(variances, variances.maxCoeff());
}

}  // namespace

LocalKernels::LocalKernels(Eigen::MatrixXd samples, Eigen::MatrixXi neighbours, double spread,
                           double floor, bool stratified)
    : samples_(std::move(samples)),
      neighbours_(std::move(neighbours)),
      spread_(spread),
      floor_(floor),
      stratified_(stratified) {
  place_kernels();
}

void LocalKernels::place_kernels() {
  const Eigen::Index m = samples_.rows(), k = neighbours_.cols(), d = dimensions();
  const double kept = std::sqrt(1 - spread_ * spread_);
  const double drawn = spread_ * std::sqrt((1 - floor_) / static_cast<double>(k));
  Eigen::VectorXd middle = Eigen::VectorXd::Zero(d), near = middle;
  kernels_.resize(static_cast<std::size_t>(m));
  for (Eigen::Index i = 0; i < m; ++i) {
    Kernel& kernel = kernels_[static_cast<std::size_t>(i)];
    kernel.ways.resize(d, k + 1);
    kernel.ways.col(0) = samples_.row(i).transpose();
    for (Eigen::Index j = 0; j < k; ++j)
      kernel.ways.col(j + 1) = samples_.row(neighbours_(i, j)).transpose();
    const Eigen::VectorXd mean = kernel.ways.rowwise().mean();
    kernel.ways.colwise() -= mean;
    kernel.centre = mean + kept * kernel.ways.col(0);
    middle += kernel.centre / static_cast<double>(m);
    near += kernel.ways.rowwise().squaredNorm() / static_cast<double>(m * k);
    kernel.ways *= drawn;
  }
  const Eigen::VectorXd wanted = variances_of(samples_);
  near = at_least(near, wanted.maxCoeff());
  Eigen::VectorXd whole = spread_ * spread_ * near;
  for (const Kernel& kernel : kernels_)
    whole += (kernel.centre - middle).cwiseAbs2() / static_cast<double>(m);
  const Eigen::VectorXd back = wanted.cwiseQuotient(whole).cwiseSqrt();
  noise_ = spread_ * std::sqrt(floor_) * back.cwiseProduct(near.cwiseSqrt());
  const Eigen::VectorXd mean = samples_.colwise().mean().transpose();
  for (Kernel& kernel : kernels_) {
    kernel.centre = (mean + back.cwiseProduct(kernel.centre - middle)).cwiseQuotient(noise_);
    kernel.ways = back.cwiseQuotient(noise_).asDiagonal() * kernel.ways;
    Eigen::MatrixXd inner = kernel.ways.transpose() * kernel.ways;
    inner.diagonal().array() += 1;
    kernel.inner.compute(inner);
  }
}

Eigen::MatrixXd LocalKernels::sample(Eigen::Index count, Random& random) const {
  const Eigen::Index m = samples_.rows();
  const auto which = draw_indices(Eigen::VectorXd::Constant(m, 1 / static_cast<double>(m)), count,
                                  stratified_, random);
  Eigen::MatrixXd drawn(count, dimensions());
  Eigen::VectorXd e(dimensions()), z(neighbours_.cols() + 1);
  for (Eigen::Index n = 0; n < count; ++n) {
    const Kernel& kernel = kernels_[static_cast<std::size_t>(which[static_cast<std::size_t>(n)])];
    for (double& each : e) each = random.normal();
    for (double& each : z) each = random.normal();
    e += kernel.centre + kernel.ways * z;
    drawn.row(n) = noise_.cwiseProduct(e).transpose();
  }
  return drawn;
}

double LocalKernels::log_density(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd at = x.cwiseQuotient(noise_);
  Eigen::VectorXd parts(samples_.rows());
  for (Eigen::Index i = 0; i < parts.size(); ++i) {
    const Kernel& kernel = kernels_[static_cast<std::size_t>(i)];
    const Eigen::VectorXd away = at - kernel.centre;
    const Eigen::VectorXd along = kernel.ways.transpose() * away;
    // The inverse of I + W W' by that of I + W' W, which is small (Woodbury).
    parts[i] = -0.5 * (away.squaredNorm() - along.dot(kernel.inner.solve(along))) -
               kernel.inner.matrixLLT().diagonal().array().log().sum();
  }
  return log_sum_exp(parts) - std::log(static_cast<double>(parts.size())) -
         noise_.array().log().sum() - 0.5 * static_cast<double>(x.size()) * std::log(2 * kPi);
}

Json LocalKernels::json() const {
  return {{"model", "Local"},
          {"samples", matrix_json(samples_)},
          {"neighbours", matrix_json(neighbours_.cast<double>())},
          {"spread", spread_},
          {"floor", floor_},
          {"stratified", stratified_}};
}

std::unique_ptr<LocalKernels> LocalKernels::read(JsonObject& object) {
  Eigen::MatrixXd samples = read_matrix(object, "samples", -1, -1);
  const Eigen::MatrixXd neighbours = read_matrix(object, "neighbours", samples.rows(), -1);
  if (samples.rows() < 2) object.fail("samples", "expected 2 rows or more");
  if (neighbours.minCoeff() < 0 || neighbours.maxCoeff() >= static_cast<double>(samples.rows()))
    object.fail("neighbours", "expected indices of samples");
  const double spread = object.number("spread", 1e-6, 1);
  const double floor = object.number("floor", 1e-6, 1);
  return std::make_unique<LocalKernels>(std::move(samples), neighbours.cast<int>(), spread, floor,
                                        object.boolean("stratified"));
}

std::unique_ptr<LocalKernels> fit_local(const Eigen::MatrixXd& samples,
                                        const SchemeOptions& options) {
  const Eigen::Index m = samples.rows();
  const Eigen::Index k = std::min<Eigen::Index>(options.neighbours, m - 1);
  Eigen::MatrixXi neighbours(m, k);
  std::vector<int> order(static_cast<std::size_t>(m));
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::VectorXd distances = (samples.rowwise() - samples.row(i)).rowwise().squaredNorm();
    for (std::size_t j = 0; j < order.size(); ++j) order[j] = static_cast<int>(j);
    // The sample itself comes first, also before others at the same place.
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      if ((a == i) != (b == i)) return a == i;
      return distances[a] != distances[b] ? distances[a] < distances[b] : a < b;
    });
    for (Eigen::Index j = 0; j < k; ++j) neighbours(i, j) = order[static_cast<std::size_t>(j + 1)];
  }
  return std::make_unique<LocalKernels>(samples, std::move(neighbours), options.spread,
                                        options.floor, options.stratified);
}

}  // namespace mocaplm
