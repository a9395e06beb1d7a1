#include "model/transformer/cpu/features.h"

#include <atomic>

#if defined(MOCAPLM_AVX512)
#include <cpuid.h>
#endif

namespace mocaplm::cpu {

namespace {

std::atomic<bool> allowed{true};

bool detect() {
#if defined(MOCAPLM_AVX512)
  unsigned a = 0, b = 0, c = 0, d = 0;
  // Leaf 7, sub-leaf 1, EAX bit 5: AVX512_BF16. The compiler's run-time checks of AVX-512 include
  // the operating system's consent.
  if (!__get_cpuid_count(7, 1, &a, &b, &c, &d) || (a >> 5 & 1) == 0) return false;
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
#else
  return false;
#endif
}

}  // namespace

bool has_avx512_bf16() {
  static const bool detected = detect();
  return detected && allowed;
}

void allow_avx512(bool value) {
  allowed = value;
}

}  // namespace mocaplm::cpu
