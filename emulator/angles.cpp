#include "emulator/angles.h"

#include "emulator/angles_body.h"

namespace mocaplm {

#if defined(MOCAPLM_X86_ANGLES)
double angle_sum_avx2(const double* a, const double* b, std::int64_t blocks);
double angle_sum_avx512(const double* a, const double* b, std::int64_t blocks);
#endif

const std::vector<AngleKernel>& angle_kernels() {
  static const std::vector<AngleKernel> kernels = [] {
    std::vector<AngleKernel> all = {{"plain", &angle_sum}};
#if defined(MOCAPLM_X86_ANGLES)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
      all.push_back({"avx2", &angle_sum_avx2});
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
      all.push_back({"avx512", &angle_sum_avx512});
#endif
    return all;
  }();
  return kernels;
}

}  // namespace mocaplm
