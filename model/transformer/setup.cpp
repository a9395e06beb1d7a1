#include "model/transformer/setup.h"

#include <ATen/Parallel.h>
#include <malloc.h>
#include <sys/resource.h>
#include <torch/cuda.h>

#include <algorithm>
#include <limits>
#include <thread>

#include "common/error.h"
#include "model/transformer/cpu/features.h"

namespace mocaplm {

namespace {

constexpr std::uint64_t kMiB = 1 << 20;

std::uint64_t address_space_limit() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}

// Under a limit (ulimit -v) each thread of OpenBLAS needs a buffer of 128 MiB, and it asks again
// for ever when it gets none: so few enough threads are used, and a limit too small for one is
// refused.
int threads_within(std::uint64_t limit) {
  if (limit == RLIM_INFINITY) return std::numeric_limits<int>::max();
  if (limit < 1200 * kMiB)
    throw UsageError("the address space is limited to " + std::to_string(limit / kMiB) +
                     " MiB (ulimit -v): LibTorch needs 1200 MiB or more");
  return static_cast<int>(std::clamp<std::uint64_t>((limit - 1024 * kMiB) / (256 * kMiB), 1, 1024));
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
  return device.is_cuda() || cpu::has_avx512_bf16() ? at::kBFloat16 : at::kFloat;
}

void set_up_cpu(int threads) {
  const int cores = std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
  const std::uint64_t limit = address_space_limit();
  at::set_num_threads(std::min(threads > 0 ? threads : cores, threads_within(limit)));
  ::mallopt(M_MMAP_THRESHOLD, 1 << 30);
  ::mallopt(M_TRIM_THRESHOLD, 2047 << 20);
  if (limit == RLIM_INFINITY) ::mallopt(M_TOP_PAD, 64 << 20);
}

}  // namespace mocaplm
