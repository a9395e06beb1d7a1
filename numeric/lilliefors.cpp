#include "numeric/lilliefors.h"

#include <Eigen/QR>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/random.h"
#include "numeric/distributions.h"

namespace mocaplm {

double lilliefors_statistic(const Eigen::VectorXd& values) {
  const auto n = static_cast<double>(values.size());
  std::vector<double> sorted(values.data(), values.data() + values.size());
  std::sort(sorted.begin(), sorted.end());
  const double mean = values.mean();
  const double deviation = std::sqrt((values.array() - mean).square().sum() / (n - 1));
  if (!(deviation > 0)) return 0;
  double most = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double p = normal_cdf((sorted[i] - mean) / deviation);
    const auto below = static_cast<double>(i);
    most = std::max({most, p - below / n, (below + 1) / n - p});
  }
  return most;
}

LillieforsNull::LillieforsNull(Eigen::Index n, int simulations, std::uint64_t seed) {
  // The statistic takes the mean away itself.
  simulate(Eigen::MatrixXd(n, 0), n, simulations, seed);
}

LillieforsNull::LillieforsNull(const Eigen::MatrixXd& design, int simulations, std::uint64_t seed) {
  const Eigen::Index n = design.rows();
  Eigen::MatrixXd columns(n, design.cols() + 1);
  columns << design.rowwise() - design.colwise().mean(), Eigen::VectorXd::Ones(n);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(n, qr.rank());
  simulate(q, n, simulations, seed);
}

void LillieforsNull::simulate(const Eigen::MatrixXd& basis, Eigen::Index n, int simulations,
                              std::uint64_t seed) {
  assert(n > basis.cols() + 2 && simulations > 0);
  Random random(seed);
  Eigen::VectorXd values(n);
  for (int i = 0; i < simulations; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) values(j) = random.normal();
    if (basis.cols() > 0) values -= basis * (basis.transpose() * values);
    sorted_.push_back(lilliefors_statistic(values));
  }
  std::sort(sorted_.begin(), sorted_.end());
}

double LillieforsNull::p_value(double statistic) const {
  const auto reached =
      sorted_.end() - std::lower_bound(sorted_.begin(), sorted_.end(), statistic - 1e-12);
  return static_cast<double>(reached + 1) / static_cast<double>(sorted_.size() + 1);
}

double LillieforsNull::critical(double alpha) const {
  const double at = (1 - alpha) * static_cast<double>(sorted_.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(below);
  const std::size_t above = std::min(below + 1, sorted_.size() - 1);
  return sorted_[below] * (1 - share) + sorted_[above] * share;
}

}  // namespace mocaplm
