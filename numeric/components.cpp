#include "numeric/components.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm {

namespace {

constexpr int kMostIterations = 500;
constexpr double kTolerance = 1e-6;

struct Spectrum {
  Eigen::RowVectorXd mean;
  Eigen::MatrixXd vectors;   // (d, d), by falling variance
  Eigen::VectorXd variance;  // (d)
};

// The column's largest entry becomes positive, so that a direction has one sign everywhere.
void fix_sign(Eigen::Ref<Eigen::VectorXd> column) {
  Eigen::Index largest = 0;
  column.cwiseAbs().maxCoeff(&largest);
  if (column[largest] < 0) column = -column;
}

Spectrum spectrum_of(const Eigen::MatrixXd& x) {
  if (!x.allFinite())
    throw DataError(in_file("component analysis"), "the values are not all finite");
  Spectrum spectrum;
  spectrum.mean = x.colwise().mean();
  const Eigen::MatrixXd centred = x.rowwise() - spectrum.mean;
  const Eigen::MatrixXd covariance = centred.transpose() * centred / static_cast<double>(x.rows());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  spectrum.vectors = eigen.eigenvectors().rowwise().reverse();
  spectrum.variance = eigen.eigenvalues().reverse().cwiseMax(0);
  for (Eigen::Index k = 0; k < x.cols(); ++k) fix_sign(spectrum.vectors.col(k));
  return spectrum;
}

// (W W^T)^-1/2 W: the orthogonal matrix nearest to W, all rows alike.
Eigen::MatrixXd decorrelate(const Eigen::MatrixXd& w) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(w * w.transpose());
  return eigen.operatorInverseSqrt() * w;
}

// The rotation (k, k) of white samples z (n, k) whose rows give the independent directions.
Eigen::MatrixXd rotate_to_independence(const Eigen::MatrixXd& z, std::uint64_t seed,
                                       IcaReport& report) {
  const Eigen::Index k = z.cols();
  const auto n = static_cast<double>(z.rows());
  Random random(seed);
  Eigen::MatrixXd w(k, k);
  for (Eigen::Index i = 0; i < k * k; ++i) w.data()[i] = random.normal();
  w = decorrelate(w);
  while (report.iterations < kMostIterations && !report.converged) {
    ++report.iterations;
    const Eigen::MatrixXd g = (z * w.transpose()).array().tanh().matrix();  // (n, k)
    const Eigen::VectorXd slope = (1 - g.array().square()).colwise().mean().transpose();
    const Eigen::MatrixXd next =
        decorrelate(g.transpose() * z / n - Eigen::MatrixXd(slope.asDiagonal() * w));
    // How far the direction that turned most has turned; its sign does not matter.
    const double turned = (1 - (next.array() * w.array()).rowwise().sum().abs()).abs().maxCoeff();
    w = next;
    report.converged = turned < kTolerance;
  }
  return w;
}

}  // namespace

Components principal_components(const Eigen::MatrixXd& x, Eigen::Index k) {
  assert(x.rows() >= 1 && k >= 1 && k <= x.cols());
  const Spectrum spectrum = spectrum_of(x);
  Components components;
  components.mean = spectrum.mean;
  components.analysis = spectrum.vectors.leftCols(k);
  components.synthesis = components.analysis.transpose();
  return components;
}

Components independent_components(const Eigen::MatrixXd& x, Eigen::Index k, std::uint64_t seed,
                                  IcaReport* told) {
  assert(x.rows() >= 1 && k >= 1 && k <= x.cols());
  const Spectrum spectrum = spectrum_of(x);
  const double least = 1e-12 * std::max(spectrum.variance[0], 1e-300);
  while (k > 1 && spectrum.variance[k - 1] <= least) --k;
  const Eigen::VectorXd deviation = spectrum.variance.head(k).cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd basis = spectrum.vectors.leftCols(k);
  const Eigen::MatrixXd whiten = basis * deviation.cwiseInverse().asDiagonal();  // (d, k)
  IcaReport report;
  const Eigen::MatrixXd w =
      rotate_to_independence((x.rowwise() - spectrum.mean) * whiten, seed, report);
  if (told) *told = report;

  // Mixing: what one unit of a source adds to x. The longer, the more variance.
  Eigen::MatrixXd mixing = basis * deviation.asDiagonal() * w.transpose();  // (d, k)
  Eigen::MatrixXd unmixing = whiten * w.transpose();                        // (d, k)
  std::vector<Eigen::Index> order(static_cast<std::size_t>(k));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const Eigen::RowVectorXd length = mixing.colwise().norm();
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return length[a] > length[b]; });
  Components components;
  components.mean = spectrum.mean;
  components.analysis.resize(x.cols(), k);
  components.synthesis.resize(k, x.cols());
  for (Eigen::Index i = 0; i < k; ++i) {
    const Eigen::Index from = order[static_cast<std::size_t>(i)];
    Eigen::VectorXd direction = mixing.col(from) / std::max(length[from], 1e-300);
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    const double sign = direction[largest] < 0 ? -1 : 1;
    components.synthesis.row(i) = sign * direction.transpose();
    components.analysis.col(i) = sign * length[from] * unmixing.col(from);
  }
  return components;
}

}  // namespace mocaplm
