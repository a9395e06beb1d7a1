#include "emulator/local.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "emulator/gaussians.h"
#include "emulator/reduction.h"

namespace mocaplm {

LocalKernels::LocalKernels(Eigen::MatrixXd samples, Eigen::MatrixXi neighbours,
                           Eigen::VectorXd deviations, double spread, double floor, bool stratified)
    : samples_(std::move(samples)),
      neighbours_(std::move(neighbours)),
      deviations_(std::move(deviations)),
      spread_(spread),
      floor_(floor),
      stratified_(stratified),
      white_(deviations_.cwiseInverse().asDiagonal() * samples_.transpose()) {}

Eigen::MatrixXd LocalKernels::sample(Eigen::Index count, Random& random) const {
  const Eigen::Index m = samples_.rows(), k = neighbours_.cols();
  const auto which = draw_indices(Eigen::VectorXd::Constant(m, 1 / static_cast<double>(m)), count,
                                  stratified_, random);
  Eigen::MatrixXd drawn(count, dimensions());
  Eigen::VectorXd e(dimensions());
  for (Eigen::Index n = 0; n < count; ++n) {
    const Eigen::Index i = which[static_cast<std::size_t>(n)];
    for (Eigen::Index c = 0; c < e.size(); ++c) e[c] = random.normal();
    drawn.row(n) = samples_.row(i) + floor_ * deviations_.cwiseProduct(e).transpose();
    for (Eigen::Index j = 0; j < k; ++j)
      drawn.row(n) += spread_ / std::sqrt(static_cast<double>(k)) * random.normal() *
                      (samples_.row(neighbours_(i, j)) - samples_.row(i));
  }
  return drawn;
}

double LocalKernels::log_density(const Eigen::VectorXd& x) const {
  const Eigen::Index m = samples_.rows(), k = neighbours_.cols(), d = dimensions();
  const Eigen::VectorXd at = x.cwiseQuotient(deviations_);
  const double floor2 = floor_ * floor_;
  Eigen::VectorXd parts(m);
  Eigen::MatrixXd ways(d, k);
  for (Eigen::Index i = 0; i < m; ++i) {
    // In units of D a kernel's covariance is f^2 I + W W': its inverse and determinant follow from
    // those of f^2 I + W' W, which is small (Woodbury).
    for (Eigen::Index j = 0; j < k; ++j)
      ways.col(j) = spread_ / std::sqrt(static_cast<double>(k)) *
                    (white_.col(neighbours_(i, j)) - white_.col(i));
    const Eigen::VectorXd away = at - white_.col(i);
    Eigen::MatrixXd inner = ways.transpose() * ways;
    inner.diagonal().array() += floor2;
    const Eigen::LLT<Eigen::MatrixXd> llt(inner);
    const Eigen::VectorXd along = ways.transpose() * away;
    const double square = (away.squaredNorm() - along.dot(llt.solve(along))) / floor2;
    const Eigen::MatrixXd lower = llt.matrixL();
    const double log_det =
        2 * lower.diagonal().array().log().sum() + static_cast<double>(d - k) * std::log(floor2);
    parts[i] = -0.5 * (square + log_det);
  }
  return log_sum_exp(parts) - std::log(static_cast<double>(m)) - deviations_.array().log().sum() -
         0.5 * static_cast<double>(d) * std::log(2 * M_PI);
}

Json LocalKernels::json() const {
  return {{"model", "Local"},
          {"samples", matrix_json(samples_)},
          {"neighbours", matrix_json(neighbours_.cast<double>())},
          {"deviations", matrix_json(deviations_)},
          {"spread", spread_},
          {"floor", floor_},
          {"stratified", stratified_}};
}

std::unique_ptr<LocalKernels> LocalKernels::read(JsonObject& object) {
  Eigen::MatrixXd samples = read_matrix(object, "samples", -1, -1);
  const Eigen::MatrixXd neighbours = read_matrix(object, "neighbours", samples.rows(), -1);
  const Eigen::MatrixXd deviations = read_matrix(object, "deviations", samples.cols(), 1);
  if (deviations.minCoeff() <= 0) object.fail("deviations", "expected positive numbers");
  if (neighbours.minCoeff() < 0 || neighbours.maxCoeff() >= static_cast<double>(samples.rows()))
    object.fail("neighbours", "expected indices of samples");
  const double spread = object.number("spread", 0, 1e6);
  const double floor = object.number("floor", 1e-6, 1e6);
  return std::make_unique<LocalKernels>(std::move(samples), neighbours.cast<int>(),
                                        deviations.col(0), spread, floor,
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
  const Eigen::MatrixXd centred = samples.rowwise() - samples.colwise().mean();
  Eigen::VectorXd deviations =
      centred.colwise().norm().transpose() / std::sqrt(static_cast<double>(m - 1));
  // What never varies still needs a density.
  deviations = deviations.cwiseMax(std::max(1e-5 * deviations.maxCoeff(), 1e-150));
  return std::make_unique<LocalKernels>(samples, std::move(neighbours), std::move(deviations),
                                        options.spread, options.floor, options.stratified);
}

}  // namespace mocaplm
