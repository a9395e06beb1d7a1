#include "numeric/distributions.h"

#include <cassert>
#include <cmath>

namespace mocaplm {

namespace {

// The continued fraction of I_x(a, b), which converges quickly for x < (a + 1) / (a + b + 2).
double beta_fraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  const auto not_zero = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
  double c = 1, d = 1 / not_zero(1 - (a + b) * x / (a + 1)), value = d;
  for (int m = 1; m <= 10000; ++m) {
    const double k = m;
    const double even = k * (b - k) * x / ((a + 2 * k - 1) * (a + 2 * k));
    d = 1 / not_zero(1 + even * d);
    c = not_zero(1 + even / c);
    value *= d * c;
    const double odd = -(a + k) * (a + b + k) * x / ((a + 2 * k) * (a + 2 * k + 1));
    d = 1 / not_zero(1 + odd * d);
    c = not_zero(1 + odd / c);
    value *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return value;
}

// The x in [low, high] where the rising function `cdf` is p.
template <class Cdf>
double solve(const Cdf& cdf, double p, double low, double high) {
  for (int i = 0; i < 200 && high - low > 1e-15 * (std::abs(low) + std::abs(high)); ++i) {
    const double middle = (low + high) / 2;
    (cdf(middle) < p ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

double incomplete_beta(double a, double b, double x) {
  assert(a > 0 && b > 0 && x >= 0 && x <= 1);
  if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
  return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

double normal_cdf(double z) {
  return std::erfc(-z / std::sqrt(2.0)) / 2;
}

double f_cdf(double x, double d1, double d2) {
  if (!(x > 0)) return 0;
  return std::isinf(x) ? 1 : incomplete_beta(d1 / 2, d2 / 2, d1 * x / (d1 * x + d2));
}

double f_tail(double x, double d1, double d2) {
  if (!(x > 0)) return 1;
  return std::isinf(x) ? 0 : incomplete_beta(d2 / 2, d1 / 2, d2 / (d1 * x + d2));
}

double f_quantile(double p, double d1, double d2) {
  assert(p > 0 && p < 1);
  double high = 1;
  while (f_cdf(high, d1, d2) < p && high < 1e300) high *= 2;
  return solve([&](double x) { return f_cdf(x, d1, d2); }, p, 0, high);
}

double t_tails(double t, double dof) {
  return f_tail(t * t, 1, dof);
}

double t_quantile(double p, double dof) {
  assert(p > 0 && p < 1);
  if (p == 0.5) return 0;
  const double size = std::sqrt(f_quantile(std::abs(2 * p - 1), 1, dof));
  return p < 0.5 ? -size : size;
}

}  // namespace mocaplm
