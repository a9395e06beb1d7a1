// Taylor series of sine and cosine in the square of the angle: no branch, no division, no table.
#pragma once

#include <cstddef>

namespace mocaplm {

// 1 / 0!, -1 / 2!, 1 / 4!, ...: cos(x) = sum of kCosine[i] z^i, z = x^2.
constexpr double kCosine[] = {1,
                              -1.0 / 2,
                              1.0 / 24,
                              -1.0 / 720,
                              1.0 / 40320,
                              -1.0 / 3628800,
                              1.0 / 479001600,
                              -1.0 / 87178291200,
                              1.0 / 20922789888000,
                              -1.0 / 6402373705728000,
                              1.0 / 2432902008176640000};
// 1 / 1!, -1 / 3!, 1 / 5!, ...: sin(x) / x = sum of kSinc[i] z^i.
constexpr double kSinc[] = {1,
                            -1.0 / 6,
                            1.0 / 120,
                            -1.0 / 5040,
                            1.0 / 362880,
                            -1.0 / 39916800,
                            1.0 / 6227020800,
                            -1.0 / 1307674368000,
                            1.0 / 355687428096000,
                            -1.0 / 121645100408832000,
                            1.0 / 51090942171709440000.0};

// The first `Terms` terms at z, by Horner's rule.
template <std::size_t Terms, std::size_t Size>
inline double series(const double (&coefficients)[Size], double z) {
  static_assert(Terms >= 1 && Terms <= Size);
  double sum = coefficients[Terms - 1];
  for (std::size_t i = Terms - 1; i-- > 0;) sum = coefficients[i] + z * sum;
  return sum;
}

}  // namespace mocaplm
