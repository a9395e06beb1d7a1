#include "gesture/basis.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/angles.h"

namespace mocaplm {

Eigen::VectorXd Basis::at(double tau) const {
  Eigen::VectorXd phi(size());
  phi(0) = 1;
  phi(1) = tau;
  for (int k = 1; k <= harmonics_; ++k) phi(k + 1) = std::sin(k * kPi * tau);
  return phi;
}

Eigen::VectorXd Basis::derivative(double tau) const {
  Eigen::VectorXd phi(size());
  phi(0) = 0;
  phi(1) = 1;
  for (int k = 1; k <= harmonics_; ++k) phi(k + 1) = k * kPi * std::cos(k * kPi * tau);
  return phi;
}

Eigen::VectorXd Basis::second(double tau) const {
  Eigen::VectorXd phi = Eigen::VectorXd::Zero(size());
  for (int k = 1; k <= harmonics_; ++k) phi(k + 1) = -k * kPi * k * kPi * std::sin(k * kPi * tau);
  return phi;
}

Eigen::MatrixXd Basis::table(Eigen::Index samples) const {
  assert(samples >= 2);
  Eigen::MatrixXd table(samples, size());
  const auto last = static_cast<double>(samples - 1);
  for (Eigen::Index j = 0; j < samples; ++j) {
    table(j, 0) = 1;
    table(j, 1) = static_cast<double>(j) / last;
    for (int k = 1; k <= harmonics_; ++k) {
      // Whole periods taken away first: the ends are exactly zero.
      const auto turn = static_cast<double>((k * j) % (2 * (samples - 1)));
      table(j, k + 1) = turn == 0 || turn == last ? 0 : std::sin(kPi * turn / last);
    }
  }
  return table;
}

Eigen::MatrixXd resample(const Eigen::VectorXd& time, const Eigen::MatrixXd& values,
                         Eigen::Index samples) {
  const Eigen::Index n = time.size();
  assert(n >= 2 && values.rows() == n && samples >= 2);
  const Eigen::Index last = n - 2;  // the last piece
  const auto secant = [&](Eigen::Index i) -> Eigen::RowVectorXd {
    return (values.row(i + 1) - values.row(i)) / (time(i + 1) - time(i));
  };
  const auto slope = [&](Eigen::Index i) -> Eigen::RowVectorXd {
    if (n == 2) return secant(0);
    const Eigen::Index middle = std::clamp<Eigen::Index>(i, 1, n - 2);
    const double before = time(middle) - time(middle - 1), after = time(middle + 1) - time(middle);
    const Eigen::RowVectorXd first = secant(middle - 1), second = secant(middle);
    const Eigen::RowVectorXd bend = (second - first) / (before + after);
    return first + bend * before + 2 * bend * (time(i) - time(middle));
  };
  Eigen::MatrixXd out(samples, values.cols());
  Eigen::Index piece = 0;
  for (Eigen::Index j = 0; j < samples; ++j) {
    const double share = static_cast<double>(j) / static_cast<double>(samples - 1);
    const double at = time(0) + share * (time(n - 1) - time(0));
    while (piece < last && at >= time(piece + 1)) ++piece;
    const double step = time(piece + 1) - time(piece);
    const double u = std::clamp((at - time(piece)) / step, 0.0, 1.0);
    out.row(j) = (1 + 2 * u) * (1 - u) * (1 - u) * values.row(piece) +
                 u * (1 - u) * (1 - u) * step * slope(piece) +
                 u * u * (3 - 2 * u) * values.row(piece + 1) -
                 u * u * (1 - u) * step * slope(piece + 1);
  }
  out.row(samples - 1) = values.row(n - 1);
  return out;
}

Expansion::Expansion(int harmonics, Eigen::Index samples)
    : basis_(harmonics), table_(basis_.table(samples)) {
  assert(samples >= harmonics + 2);
  transform_ =
      table_.block(1, 2, samples - 2, harmonics).transpose() * 2 / static_cast<double>(samples - 1);
}

Eigen::MatrixXd Expansion::coefficients(const Eigen::MatrixXd& values) const {
  assert(values.rows() == samples());
  Eigen::MatrixXd p(basis_.size(), values.cols());
  p.row(0) = values.row(0);
  p.row(1) = values.row(samples() - 1) - values.row(0);
  const Eigen::MatrixXd rest = values - table_.leftCols(2) * p.topRows(2);
  p.bottomRows(basis_.harmonics()) = transform_ * rest.middleRows(1, samples() - 2);
  return p;
}

}  // namespace mocaplm
