#include "model/transformer/setup.h"

#include <ATen/Parallel.h>
#include <cpuid.h>
#include <malloc.h>
#include <torch/cuda.h>

#include <thread>

#include "common/error.h"

namespace mocaplm {

namespace {

// CPUID leaf 7, sub-leaf 1, EAX bit 5: AVX512_BF16. Its support by the system follows from
// AVX-512F's.
bool cpu_has_bf16() {
#if defined(__x86_64__)
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (!__get_cpuid_count(7, 1, &a, &b, &c, &d)) return false;
  return (a >> 5 & 1) != 0 && __builtin_cpu_supports("avx512f") != 0;
#else
  return false;
#endif
}

}  // namespace

at::Device choose_device(const std::string& name) {
  const bool cuda = torch::cuda::is_available();
  if (name == "cuda" && !cuda)
    throw UsageError("--device cuda: this LibTorch finds no CUDA device; use --device cpu or auto");
  return at::Device(name == "cuda" || (name == "auto" && cuda) ? at::kCUDA : at::kCPU);
}

at::ScalarType choose_precision(const std::string& name, const at::Device& device) {
  if (name == "bf16") return at::kBFloat16;
  if (name == "f32") return at::kFloat;
  return device.is_cuda() || cpu_has_bf16() ? at::kBFloat16 : at::kFloat;
}

void set_up_cpu(int threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  at::set_num_threads(threads > 0 ? threads : std::max(cores, 1));
  ::mallopt(M_MMAP_THRESHOLD, 1 << 30);
  ::mallopt(M_TRIM_THRESHOLD, 2047 << 20);
  ::mallopt(M_TOP_PAD, 64 << 20);
}

}  // namespace mocaplm
