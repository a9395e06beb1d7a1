#include "generate/kernels/level.h"

#include <algorithm>
#include <cassert>

namespace mocaplm {

namespace {

KernelLevel& current_level() {
  static KernelLevel level = best_kernel_level();
  return level;
}

}  // namespace

KernelLevel best_kernel_level() {
#if defined(MOCAPLM_X86_KERNELS)
  __builtin_cpu_init();
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512vnni");
  if (avx512 && __builtin_cpu_supports("avx512bf16")) return KernelLevel::avx512_bf16;
  if (avx512) return KernelLevel::avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return KernelLevel::avx2;
#endif
  return KernelLevel::plain;
}

KernelLevel kernel_level() {
  return current_level();
}

void set_kernel_level(KernelLevel level) {
  current_level() = std::min(level, best_kernel_level());
}

std::string to_string(KernelLevel level) {
  switch (level) {
    case KernelLevel::avx512_bf16:
      return "AVX-512 with BF16";
    case KernelLevel::avx512:
      return "AVX-512 with VNNI";
    case KernelLevel::avx2:
      return "AVX2";
    default:
      return "plain C++";
  }
}

const std::vector<std::string>& precision_names() {
  static const std::vector<std::string> names = {"f32", "bf16", "int8"};
  return names;
}

std::string to_string(Precision precision) {
  return precision_names()[static_cast<std::size_t>(precision)];
}

Precision named_precision(const std::string& name) {
  const auto& names = precision_names();
  const auto found = std::find(names.begin(), names.end(), name);
  assert(found != names.end());
  return static_cast<Precision>(found - names.begin());
}

}  // namespace mocaplm
