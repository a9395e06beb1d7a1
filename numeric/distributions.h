// Distribution functions for tests and intervals: normal, Student's t and Fisher's F, the last two
// by the regularised incomplete beta function.
#pragma once

namespace mocaplm {

// I_x(a, b) for a, b > 0 and x in [0, 1], by its continued fraction (Lentz's method; Press et al.,
// "Numerical Recipes", 6.4).
double incomplete_beta(double a, double b, double x);

double normal_cdf(double z);

// P(F <= x) and P(F > x) for F with (d1, d2) degrees of freedom, which are positive; the second
// keeps its digits where it is tiny. x = infinity is allowed.
double f_cdf(double x, double d1, double d2);
double f_tail(double x, double d1, double d2);
// The x with f_cdf(x) = p, p in (0, 1).
double f_quantile(double p, double d1, double d2);

// P(|T| > |t|) for Student's t, and the t with P(T <= t) = p.
double t_tails(double t, double dof);
double t_quantile(double p, double dof);

}  // namespace mocaplm
