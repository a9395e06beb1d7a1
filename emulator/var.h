// Vector autoregression of order p (section 4.3.2; Hamilton 1994, chapter 11).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/json.h"
#include "common/random.h"

namespace mocaplm {

//   x(t) = c + A_1 x(t - 1) + ... + A_p x(t - p) + e(t),   e ~ N(0, S)
// fitted to all courses together by least squares, with a ridge of 1e-8 of the mean square.
struct VectorAutoregression {
  Eigen::MatrixXd weights;              // (d, 1 + d p): c, A_1, ..., A_p
  Eigen::MatrixXd factor;               // (d, d) lower: S = factor factor'
  std::vector<Eigen::MatrixXd> starts;  // (d, p) first frames of each course

  Eigen::Index dimensions() const { return weights.rows(); }
  Eigen::Index order() const { return (weights.cols() - 1) / weights.rows(); }
  // Goes on from the first frames of a course of the data; values are kept within 1e6, as an
  // unstable fit grows without limit.
  Eigen::MatrixXd sample(Eigen::Index frames, Random& random) const;
  // Of frames p .. T - 1, given those before.
  double log_likelihood(const Eigen::MatrixXd& course) const;
};

// courses (d, T), all of T > p frames. Throws UsageError for T <= p + 1.
VectorAutoregression fit_var(const std::vector<Eigen::MatrixXd>& courses, Eigen::Index order);
Json var_json(const VectorAutoregression& var);
VectorAutoregression read_var(const Json& json, const std::string& place);

}  // namespace mocaplm
