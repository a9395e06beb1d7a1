// The loop for AVX-512; called only after the processor was asked.
#include "emulator/angles_body.h"

namespace mocaplm {

double angle_sum_avx512(const double* a, const double* b, std::int64_t blocks) {
  return angle_sum(a, b, blocks);
}

}  // namespace mocaplm
