#include "numeric/distributions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"

namespace mocaplm::distributions_test {
namespace {

TEST(Distributions, IncompleteBetaHasItsClosedForms) {
  for (const double x : {0.01, 0.2, 0.5, 0.77, 0.999}) {
    EXPECT_NEAR(incomplete_beta(1, 1, x), x, 1e-14);
    EXPECT_NEAR(incomplete_beta(1, 7, x), 1 - std::pow(1 - x, 7), 1e-13);
    EXPECT_NEAR(incomplete_beta(4, 1, x), std::pow(x, 4), 1e-13);
    EXPECT_NEAR(incomplete_beta(0.5, 0.5, x), 2 / kPi * std::asin(std::sqrt(x)), 1e-13);
    EXPECT_NEAR(incomplete_beta(3.5, 20, x) + incomplete_beta(20, 3.5, 1 - x), 1, 1e-13);
  }
  EXPECT_EQ(incomplete_beta(2, 3, 0), 0);
  EXPECT_EQ(incomplete_beta(2, 3, 1), 1);
}

// The density, integrated by Simpson's rule.
TEST(Distributions, FAgreesWithAnIntegralOfItsDensity) {
  for (const auto& [d1, d2] : {std::pair{3.0, 10.0}, {6.0, 50.0}, {12.0, 4.0}, {40.0, 200.0}}) {
    const double front = std::exp(std::lgamma((d1 + d2) / 2) - std::lgamma(d1 / 2) -
                                  std::lgamma(d2 / 2) + d1 / 2 * std::log(d1 / d2));
    const auto density = [&, a = d1, b = d2](double x) {
      return front * std::pow(x, a / 2 - 1) * std::pow(1 + a * x / b, -(a + b) / 2);
    };
    // Where a is 3 the density has a root at 0: substitute x = u^2.
    const auto inner = [&](double u) { return density(u * u) * 2 * u; };
    for (const double x : {0.3, 1.0, 2.5}) {
      const int steps = 20000;
      const double h = std::sqrt(x) / steps;
      double sum = inner(std::sqrt(x));
      for (int i = 1; i < steps; ++i) sum += inner(i * h) * (i % 2 ? 4 : 2);
      EXPECT_NEAR(f_cdf(x, d1, d2), sum * h / 3, 1e-9) << d1 << " " << d2 << " " << x;
      EXPECT_NEAR(f_cdf(x, d1, d2) + f_tail(x, d1, d2), 1, 1e-13);
    }
  }
}

// From the tables in textbooks (three digits or four).
TEST(Distributions, QuantilesAreThePublishedOnes) {
  EXPECT_NEAR(f_quantile(0.95, 1, 10), 4.96, 0.005);
  EXPECT_NEAR(f_quantile(0.95, 4, 20), 2.87, 0.005);
  EXPECT_NEAR(f_quantile(0.99, 4, 20), 4.43, 0.005);
  EXPECT_NEAR(f_quantile(0.95, 6, 60), 2.25, 0.005);
  EXPECT_NEAR(f_quantile(0.99, 5, 10), 5.64, 0.005);
  EXPECT_NEAR(f_quantile(0.95, 10, 5), 4.74, 0.005);
  EXPECT_NEAR(t_quantile(0.975, 1), 12.706, 0.0005);
  EXPECT_NEAR(t_quantile(0.975, 10), 2.228, 0.0005);
  EXPECT_NEAR(t_quantile(0.975, 30), 2.042, 0.0005);
  EXPECT_NEAR(t_quantile(0.05, 5), -2.015, 0.0005);
  EXPECT_NEAR(t_quantile(0.975, 1e6), 1.95996, 1e-4);
  EXPECT_NEAR(normal_cdf(1.95996398454), 0.975, 1e-11);
  EXPECT_EQ(t_quantile(0.5, 7), 0);
}

TEST(Distributions, QuantilesAreInverses) {
  for (const double p : {1e-6, 0.01, 0.3, 0.5, 0.95, 0.9999})
    for (const auto& [d1, d2] : {std::pair{1.0, 3.0}, {5.0, 40.0}, {30.0, 8.0}})
      EXPECT_NEAR(f_cdf(f_quantile(p, d1, d2), d1, d2), p, 1e-10);
}

TEST(Distributions, TailsKeepTheirDigits) {
  // F with (2, d): P(F > x) = (1 + 2 x / d)^(-d / 2).
  EXPECT_NEAR(f_tail(1000, 2, 60) / std::pow(1 + 2000.0 / 60, -30), 1, 1e-9);
  EXPECT_EQ(f_tail(INFINITY, 3, 5), 0);
  EXPECT_EQ(f_tail(0, 3, 5), 1);
  EXPECT_NEAR(t_tails(12.706, 1), 0.05, 1e-5);
}

}  // namespace
}  // namespace mocaplm::distributions_test
