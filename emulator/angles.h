// Sums of angles between unit vectors, for many at once: the inner loop of all posture distances.
//
// A row of vectors is packed in blocks of 8: x[8] y[8] z[8]. The angle of a and b is taken from
// s = |a - b|^2 / 4 = sin^2(angle / 2) and c = |a + b|^2 / 4 = cos^2(angle / 2): 2 asin(sqrt(s)),
// or pi - 2 asin(sqrt(c)) where c is the smaller. So small angles and those near pi are exact where
// arccos(a . b) has lost half of its digits, and there is no branch: with a polynomial for the
// arcsine up to sqrt(1/2) (error under 1e-13) the loop becomes vector instructions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mocaplm {

constexpr std::int64_t kAngleLanes = 8;
constexpr std::int64_t kAngleBlock = 3 * kAngleLanes;  // numbers in a block

// The sum over `blocks` blocks of the angles between a's and b's vectors, radians.
using AngleSum = double (*)(const double* a, const double* b, std::int64_t blocks);

struct AngleKernel {
  std::string name;  // "plain", "avx2", "avx512"
  AngleSum sum;
};

// Those that this processor can run, the best last.
const std::vector<AngleKernel>& angle_kernels();

}  // namespace mocaplm
