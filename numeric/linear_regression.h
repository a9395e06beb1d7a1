// Linear regression of several responses on the same conditions, with what is known of its errors.
//   y_i = F [x_i; 1] + e_i,   F (r, k + 1), its last column for the 1
#pragma once

#include <Eigen/Core>

namespace mocaplm {

struct RegressionOptions {
  // Shrinks the slopes: adds ridge * n * |slope * standard deviation of its condition|^2 to the
  // squared error. The constant is never shrunk. 0: none.
  double ridge = 0;
  // Outliers count less: an MM-estimate (Yohai 1987), for each response by itself. It starts from
  // the least trimmed squares (Rousseeuw 1984) over half of the rows, which also gives the scale,
  // and reweights by Tukey's bisquare with 4.685, 95% as efficient where there are no outliers.
  bool robust = false;
};

struct LinearRegression {
  Eigen::MatrixXd f;             // (r, k + 1)
  Eigen::MatrixXd residuals;     // (n, r)
  Eigen::MatrixXd weights;       // (n, r): 1, or how far a robust fit believes the row, 0 to 1
  Eigen::MatrixXd gram_inverse;  // (k + 1, k + 1): inverse of sum [x; 1] [x; 1]' (+ ridge)
  Eigen::VectorXd leverage;      // (n): [x_i; 1]' gram_inverse [x_i; 1]
  Eigen::Index rank = 0;         // of the conditions with the 1, at most k + 1
  double ridge = 0;

  Eigen::Index samples() const { return residuals.rows(); }
  Eigen::Index dof() const { return samples() - rank; }
  // (r, r): residual covariance with dof in the denominator; robust: of the rows as weighted, with
  // the factor that makes it consistent for normal errors.
  Eigen::MatrixXd covariance() const;
};

// x (n, k), y (n, r), k >= 0. Where conditions depend on each other, the slopes are the smallest
// ones that give the least squares (pseudo-inverse; conditions centred and scaled to unit
// variance), so that a constant condition has slope 0. Throws DataError for values that are not
// finite and for fewer than rank + 1 rows.
LinearRegression fit_linear(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                            const RegressionOptions& options = {});

// What a least squares fit says of one response.
struct ResponseStatistics {
  double r_squared = 0;
  double f = 0, f_p = 1;  // F-test: do the conditions explain anything at all?
  // (k + 1): 95% confidence intervals are f +- half_width (slopes first, the constant last).
  Eigen::VectorXd half_width;
  // (k + 1): jackknife variance of each number (Quenouille 1956, Tukey 1958), from the fits that
  // each leave one row out.
  Eigen::VectorXd jackknife_variance;
  // R^2 of each row predicted by the fit without it (1 - PRESS / total); below r_squared.
  double left_out_r_squared = 0;
};
// Of column `response`; the fit must have neither ridge nor robust weights. A response that is
// met exactly (or constant) has f = infinity (or 0) and half_width 0.
ResponseStatistics response_statistics(const LinearRegression& fit, const Eigen::MatrixXd& x,
                                       const Eigen::MatrixXd& y, Eigen::Index response);

// (n, r): what each row would be predicted as by a fit without it. Least squares and ridge use the
// leverage; a robust fit is only reweighted without the row, with no search of its own.
Eigen::MatrixXd left_out_predictions(const LinearRegression& fit, const Eigen::MatrixXd& x,
                                     const Eigen::MatrixXd& y, const RegressionOptions& options);

}  // namespace mocaplm
