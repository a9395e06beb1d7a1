#include "emulator/var.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "emulator/reduction.h"

namespace mocaplm {

namespace {

// (1 + d p): 1, x(t - 1), ..., x(t - p).
Eigen::VectorXd past_of(const Eigen::MatrixXd& course, Eigen::Index t, Eigen::Index order) {
  Eigen::VectorXd past(1 + course.rows() * order);
  past[0] = 1;
  for (Eigen::Index k = 1; k <= order; ++k)
    past.segment(1 + (k - 1) * course.rows(), course.rows()) = course.col(t - k);
  return past;
}

}  // namespace

VectorAutoregression fit_var(const std::vector<Eigen::MatrixXd>& courses, Eigen::Index order) {
  const Eigen::Index d = courses.at(0).rows(), t = courses[0].cols(), k = 1 + d * order;
  if (t <= order + 1)
    throw UsageError("VAR of order " + std::to_string(order) + " needs more than " +
                     std::to_string(order + 1) + " frames, found " + std::to_string(t));
  Eigen::MatrixXd past_past = Eigen::MatrixXd::Zero(k, k), now_past = Eigen::MatrixXd::Zero(d, k);
  for (const Eigen::MatrixXd& course : courses)
    for (Eigen::Index s = order; s < t; ++s) {
      const Eigen::VectorXd past = past_of(course, s, order);
      past_past.selfadjointView<Eigen::Lower>().rankUpdate(past);
      now_past += course.col(s) * past.transpose();
    }
  const Eigen::MatrixXd full = past_past.selfadjointView<Eigen::Lower>();
  Eigen::MatrixXd ridge = full;
  ridge.diagonal().array() += 1e-8 * full.trace() / static_cast<double>(k);
  VectorAutoregression var;
  var.weights = ridge.ldlt().solve(now_past.transpose()).transpose();
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(d, d);
  for (const Eigen::MatrixXd& course : courses) {
    for (Eigen::Index s = order; s < t; ++s) {
      const Eigen::VectorXd rest = course.col(s) - var.weights * past_of(course, s, order);
      scatter += rest * rest.transpose();
    }
    var.starts.push_back(course.leftCols(order));
  }
  scatter /= static_cast<double>(courses.size()) * static_cast<double>(t - order);
  scatter.diagonal().array() += 1e-9 * scatter.trace() / static_cast<double>(d) + 1e-300;
  var.factor = scatter.llt().matrixL();
  return var;
}

Eigen::MatrixXd VectorAutoregression::sample(Eigen::Index frames, Random& random) const {
  const Eigen::Index p = order();
  Eigen::MatrixXd course(dimensions(), std::max(frames, p));
  course.leftCols(p) = starts[random.below(starts.size())];
  Eigen::VectorXd z(dimensions());
  for (Eigen::Index t = p; t < frames; ++t) {
    for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = random.normal();
    course.col(t) = (weights * past_of(course, t, p) + factor.triangularView<Eigen::Lower>() * z)
                        .cwiseMax(-1e6)
                        .cwiseMin(1e6);
  }
  return course.leftCols(frames);
}

double VectorAutoregression::log_likelihood(const Eigen::MatrixXd& course) const {
  const double norm = -factor.diagonal().array().log().sum() -
                      0.5 * static_cast<double>(dimensions()) * std::log(2 * kPi);
  double sum = 0;
  for (Eigen::Index t = order(); t < course.cols(); ++t) {
    Eigen::VectorXd rest = course.col(t) - weights * past_of(course, t, order());
    factor.triangularView<Eigen::Lower>().solveInPlace(rest);
    sum += norm - 0.5 * rest.squaredNorm();
  }
  return sum;
}

Json var_json(const VectorAutoregression& var) {
  Json starts = Json::array();
  for (const Eigen::MatrixXd& start : var.starts) starts.push_back(matrix_json(start));
  return {{"weights", matrix_json(var.weights)},
          {"factor", matrix_json(var.factor)},
          {"starts", starts}};
}

VectorAutoregression read_var(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  VectorAutoregression var;
  var.weights = read_matrix(object, "weights", -1, -1);
  const Eigen::Index d = var.weights.rows();
  if (var.weights.cols() < 1 + d || (var.weights.cols() - 1) % d != 0)
    object.fail("weights", "expected 1 + d p columns");
  var.factor = read_matrix(object, "factor", d, d);
  if (var.factor.diagonal().minCoeff() <= 0) object.fail("factor", "expected a positive diagonal");
  const Json& starts = object.raw("starts");
  if (!starts.is_array() || starts.empty()) object.fail("starts", "expected a list of matrices");
  for (const Json& start : starts) {
    const Json one = {{"start", start}};
    JsonObject each(one, place + ": starts");
    var.starts.push_back(read_matrix(each, "start", d, var.order()));
  }
  object.finish();
  return var;
}

}  // namespace mocaplm
