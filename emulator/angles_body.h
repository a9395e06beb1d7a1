// The loop of angles.h, compiled once for each set of instructions. Everything is in an unnamed
// namespace: a copy shared between files could be one with instructions that the processor lacks.
#pragma once

#include <cstdint>

#include "common/angles.h"

namespace mocaplm {
namespace {

// asin(x) / x as a polynomial in u = x^2 on [0, 1/2]: interpolation at Chebyshev's points.
inline double arcsine_ratio(double u) {
  double p = 0.36367551951070004;
  p = p * u - 0.9701712272492978;
  p = p * u + 1.2533480048450683;
  p = p * u - 0.9548111543826145;
  p = p * u + 0.5015911372002735;
  p = p * u - 0.16571504206604917;
  p = p * u + 0.055684634270987896;
  p = p * u + 0.006106160041940498;
  p = p * u + 0.01833122710464971;
  p = p * u + 0.02228930693595427;
  p = p * u + 0.030386492925422153;
  p = p * u + 0.044642707611390164;
  p = p * u + 0.07500000256171929;
  p = p * u + 0.16666666664942262;
  return p * u + 1.000000000000019;
}

double angle_sum(const double* a, const double* b, std::int64_t blocks) {
  constexpr std::int64_t kLanes = 8;
  double sums[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (std::int64_t block = 0; block < blocks; ++block, a += 3 * kLanes, b += 3 * kLanes) {
#pragma omp simd
    for (std::int64_t i = 0; i < kLanes; ++i) {
      double s = 0, c = 0;
      for (std::int64_t axis = 0; axis < 3; ++axis) {
        const double p = a[axis * kLanes + i], q = b[axis * kLanes + i];
        s += (p - q) * (p - q);
        c += (p + q) * (p + q);
      }
      const double u = 0.25 * (s < c ? s : c);
      const double angle = 2 * __builtin_sqrt(u) * arcsine_ratio(u);
      sums[i] += s < c ? angle : kPi - angle;
    }
  }
  double sum = 0;
  for (std::int64_t i = 0; i < kLanes; ++i) sum += sums[i];
  return sum;
}

}  // namespace
}  // namespace mocaplm
