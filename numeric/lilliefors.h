// The test of normality with unknown mean and variance: Lilliefors 1967, "On the Kolmogorov-Smirnov
// test for normality with mean and variance unknown". p-values come from simulation, as his
// table did.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mocaplm {

// The largest distance between the empirical distribution of the n values, standardised with their
// mean and standard deviation (n - 1 in the denominator), and the normal one. 0 when all values are
// the same; n >= 2.
double lilliefors_statistic(const Eigen::VectorXd& values);

// The statistic's distribution when the values are normal. Of residuals of a regression it is
// another one than of independent values: the regression takes degrees of freedom away and makes
// them depend on each other. So it may be simulated for the residuals of any design.
class LillieforsNull {
 public:
  // n independent values: the published test. n >= 4.
  LillieforsNull(Eigen::Index n, int simulations, std::uint64_t seed);
  // Residuals of a regression on the columns of `design` (n, k), to which a constant is added;
  // n > rank + 2.
  LillieforsNull(const Eigen::MatrixXd& design, int simulations, std::uint64_t seed);

  // The share of simulations, with the observed one counted among them, that reach `statistic`.
  double p_value(double statistic) const;
  // What the statistic exceeds with probability alpha.
  double critical(double alpha) const;

 private:
  void simulate(const Eigen::MatrixXd& basis, Eigen::Index n, int simulations, std::uint64_t seed);

  std::vector<double> sorted_;
};

}  // namespace mocaplm
