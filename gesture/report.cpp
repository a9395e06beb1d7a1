#include "gesture/report.h"

#include <algorithm>
#include <cmath>

#include "common/random.h"
#include "numeric/distributions.h"
#include "numeric/lilliefors.h"

namespace mocaplm {

namespace {

// A least squares fit's statistics; nothing where the responses are met exactly.
struct Tested {
  LinearRegression fit;
  std::vector<ResponseStatistics> each;
};

Tested test_all(const Eigen::MatrixXd& q, const Eigen::MatrixXd& p) {
  Tested tested{fit_linear(q, p), {}};
  for (Eigen::Index j = 0; j < p.cols(); ++j)
    tested.each.push_back(response_statistics(tested.fit, q, p, j));
  return tested;
}

// The share of random halves of the demonstrations in which the F-test of each response says
// p < 0.05; less than 0 where halves are too small.
std::vector<double> significant_halves(const PhaseData& data, const ReportConfig& config) {
  const auto n = static_cast<std::size_t>(data.q.rows());
  std::vector<double> share(static_cast<std::size_t>(data.p.cols()), -1);
  if (static_cast<Eigen::Index>(n / 2) < data.q.cols() + 4 || config.partitions == 0) return share;
  std::fill(share.begin(), share.end(), 0);
  Random random(static_cast<std::uint64_t>(config.seed));
  std::vector<Eigen::Index> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<Eigen::Index>(i);
  for (std::int64_t round = 0; round < config.partitions; ++round) {
    random.shuffle(order);
    for (const bool second : {false, true}) {
      const std::size_t from = second ? n / 2 : 0, count = second ? n - n / 2 : n / 2;
      Eigen::MatrixXd q(count, data.q.cols()), p(count, data.p.cols());
      for (std::size_t i = 0; i < count; ++i) {
        q.row(static_cast<Eigen::Index>(i)) = data.q.row(order[from + i]);
        p.row(static_cast<Eigen::Index>(i)) = data.p.row(order[from + i]);
      }
      const Tested half = test_all(q, p);
      for (std::size_t j = 0; j < share.size(); ++j) share[j] += half.each[j].f_p < 0.05;
    }
  }
  for (double& one : share) one /= 2 * static_cast<double>(config.partitions);
  return share;
}

// The jackknife deviation of the slope that explains most, over the slope's size.
double jackknife_ratio(const Tested& tested, const PhaseData& data, Eigen::Index j) {
  Eigen::Index most = 0;
  double largest = -1;
  for (Eigen::Index i = 0; i < data.q.cols(); ++i) {
    const double deviation =
        std::sqrt((data.q.col(i).array() - data.q.col(i).mean()).square().mean());
    const double size = std::abs(tested.fit.f(j, i)) * deviation;
    if (size > largest) {
      largest = size;
      most = i;
    }
  }
  const double variance = tested.each[static_cast<std::size_t>(j)].jackknife_variance(most);
  return largest > 0 ? std::sqrt(variance) / std::abs(tested.fit.f(j, most)) : 0;
}

Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

// p (1 x V * M) of one demonstration with its ends set, as (M, V).
Eigen::MatrixXd with_ends(const Eigen::RowVectorXd& p, const Boundary& boundary, Eigen::Index m) {
  const Eigen::Index dimensions = boundary.start.size();
  Eigen::MatrixXd all = Eigen::Map<const Eigen::MatrixXd>(p.data(), m, dimensions);
  all.row(0) = boundary.start.transpose();
  all.row(1) = (*boundary.end - boundary.start).transpose();
  return all;
}

}  // namespace

LeftOut left_out_errors(const PhaseData& data, const GestureConfig& config) {
  const Eigen::Index n = data.q.rows(), dimensions = data.boundaries[0].start.size();
  const Expansion expansion(static_cast<int>(config.harmonics), config.samples);
  const Eigen::Index m = expansion.basis().size();
  const LinearRegression fit = fit_linear(data.q, data.p, config.regression());
  const Eigen::MatrixXd predicted = left_out_predictions(fit, data.q, data.p, config.regression());
  const Eigen::MatrixXd covariance = fit.covariance();
  const Eigen::RowVectorXd sum = data.p.colwise().sum();
  const double t = t_quantile(0.975, static_cast<double>(fit.dof()));
  const Eigen::MatrixXd phi = expansion.values(Eigen::MatrixXd::Identity(m, m));
  LeftOut out;
  double inside = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Boundary& boundary = data.boundaries[static_cast<std::size_t>(i)];
    const Eigen::MatrixXd& measured = data.movements[static_cast<std::size_t>(i)];
    const auto error = [&](const Eigen::MatrixXd& p) {
      return (expansion.values(p) - measured).array().square().mean() / static_cast<double>(n);
    };
    const Eigen::MatrixXd p = with_ends(predicted.row(i), boundary, m);
    out.each.push_back(std::sqrt(error(p) * static_cast<double>(n)));
    out.model += error(p);
    const Eigen::RowVectorXd others = (sum - data.p.row(i)) / static_cast<double>(n - 1);
    out.mean_shape += error(with_ends(others, boundary, m));
    out.line += error(with_ends(Eigen::RowVectorXd::Zero(data.p.cols()), boundary, m));
    out.truncation += error(with_ends(data.p.row(i), boundary, m));
    // The interval of this demonstration by a fit without it: its leverage there is h / (1 - h).
    const double spread = 1 / std::max(1e-12, 1 - fit.leverage(i));
    const Eigen::MatrixXd off = (expansion.values(p) - measured).cwiseAbs();
    for (Eigen::Index v = 0; v < dimensions; ++v) {
      Eigen::MatrixXd s = covariance.block(v * m, v * m, m, m);
      s.topRows(2).setZero();
      s.leftCols(2).setZero();
      const Eigen::ArrayXd variance =
          (phi * s).cwiseProduct(phi).rowwise().sum().array().max(0) * spread +
          data.truncation(v) * data.truncation(v);
      inside += static_cast<double>((off.col(v).array() <= t * variance.sqrt()).count());
    }
  }
  out.inside = inside / static_cast<double>(n * dimensions * config.samples);
  for (double* value : {&out.model, &out.mean_shape, &out.line, &out.truncation})
    *value = std::sqrt(*value);
  return out;
}

PhaseReport phase_report(const PhaseModel& model, const PhaseData& data,
                         const GestureConfig& config, const ReportConfig& report) {
  const Tested tested = test_all(data.q, data.p);
  const std::vector<double> halves = significant_halves(data, report);
  const LillieforsNull null(data.q, static_cast<int>(report.simulations),
                            static_cast<std::uint64_t>(report.seed));
  const Eigen::Index m = model.size();
  PhaseReport out{Table("phase " + model.name + ": coefficients of " +
                            std::to_string(data.q.rows()) + " demonstrations",
                        {"coefficient", "RMS", "R2", "R2 left out", "F", "p", "halves p < 0.05",
                         "normal p", "jackknife"}),
                  Table("phase " + model.name, {"", "value"})};
  out.coefficients.digits({-1, 4, 3, 3, 1, 5, 2, 3, 3});
  int relevant = 0, normal = 0, stable = 0, all = 0;
  std::vector<double> ratios;
  for (Eigen::Index v = 0; v < model.dimensions(); ++v)
    for (int k = 1; k <= model.harmonics; ++k) {
      const Eigen::Index j = v * m + k + 1;
      const ResponseStatistics& one = tested.each[static_cast<std::size_t>(j)];
      const double half = halves[static_cast<std::size_t>(j)];
      const double normal_p = null.p_value(lilliefors_statistic(tested.fit.residuals.col(j)));
      const double ratio = jackknife_ratio(tested, data, j);
      out.coefficients.row(
          {model.coordinates[static_cast<std::size_t>(v)] + " sin " + std::to_string(k) + " pi tau",
           std::sqrt(data.p.col(j).squaredNorm() / static_cast<double>(data.p.rows())),
           one.r_squared, one.left_out_r_squared, finite_or_null(one.f), one.f_p,
           half < 0 ? Json() : Json(half), normal_p, finite_or_null(ratio)});
      ++all;
      normal += normal_p >= 0.05;
      if (one.f_p >= 0.05) continue;
      ++relevant;
      stable += half >= 0.95;
      ratios.push_back(ratio);
    }
  const LeftOut left_out = left_out_errors(data, config);
  const auto of = [&](int count, int total) {
    return std::to_string(count) + " of " + std::to_string(total);
  };
  std::sort(ratios.begin(), ratios.end());
  Table& summary = out.summary;
  summary.digits({-1, 4});
  summary.row({"demonstrations", data.q.rows()});
  summary.row({"conditions (of them independent)",
               std::to_string(data.q.cols()) + " (" + std::to_string(tested.fit.rank - 1) + ")"});
  summary.row({"coefficients that depend on them (F-test, p < 0.05)", of(relevant, all)});
  summary.row({"of these, so in 95% of random halves",
               halves[0] < 0 ? Json() : Json(of(stable, relevant))});
  summary.row({"coefficients with normal residuals (Lilliefors, p >= 0.05)", of(normal, all)});
  summary.row({"jackknife deviation over slope, median of the dependent",
               ratios.empty() ? Json() : finite_or_null(ratios[ratios.size() / 2])});
  summary.row({"left out: RMS error, this model", left_out.model});
  summary.row({"left out: RMS error, mean shape", left_out.mean_shape});
  summary.row({"left out: RMS error, straight line", left_out.line});
  summary.row({"RMS error of the expansion itself", left_out.truncation});
  summary.row({"left out: samples inside the 95% interval", left_out.inside});
  if (config.robust || config.ridge > 0)
    summary.note("Tests are of a least squares fit; errors of left out ones, of the model's own.");
  return out;
}

}  // namespace mocaplm
