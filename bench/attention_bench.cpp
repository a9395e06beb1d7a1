// Causal attention of one layer, forward and backward: the own kernels beside LibTorch's products
// on blocks. `of product` is the share of the rate that a big bf16 product reaches in the same run.
#include <benchmark/benchmark.h>

#include <chrono>

#include "model/transformer/attention.h"
#include "model/transformer/cpu/features.h"
#include "model/transformer/setup.h"

namespace {

using namespace mocaplm;

// FLOP/s of a bf16 product that fits the cache well: the best of a few.
double product_rate() {
  static const double rate = [] {
    const at::Tensor a = at::randn({4096, 1024}).to(at::kBFloat16);
    const at::Tensor b = at::randn({1024, 1024}).to(at::kBFloat16);
    double best = 0;
    for (int i = 0; i < 12; ++i) {
      const auto start = std::chrono::steady_clock::now();
      benchmark::DoNotOptimize(at::linear(a, b));
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
      best = std::max(best, 2.0 * 4096 * 1024 * 1024 / seconds.count());
    }
    return best;
  }();
  return rate;
}

// Arguments: batch, length, heads, width, own kernels or not.
void attention(benchmark::State& state, bool backward) {
  set_up_cpu(0);
  const double limit = product_rate();
  cpu::allow_avx512(state.range(4) != 0);
  const std::int64_t b = state.range(0), t = state.range(1), h = state.range(2), d = state.range(3);
  at::manual_seed(1);
  at::Tensor qkv = at::randn({b, t, 3, h, d}).to(at::kBFloat16).set_requires_grad(backward);
  const at::Tensor upstream = at::randn({b, t, h, d}).to(at::kBFloat16);
  for (auto unused : state) {
    const at::Tensor out = packed_causal_attention(qkv, 0, 0);
    if (!backward) continue;
    out.backward(upstream);
    qkv.mutable_grad() = at::Tensor();
  }
  // Products over t^2 / 2 pairs: two forward, five backward.
  const double flops = 2.0 * static_cast<double>(b * h * t * t / 2 * d) * (backward ? 7 : 2);
  using benchmark::Counter;
  state.counters["GFLOP/s"] = Counter(flops * 1e-9, Counter::kIsIterationInvariantRate);
  state.counters["of product"] = Counter(flops / limit, Counter::kIsIterationInvariantRate);
  cpu::allow_avx512(true);
}

void forward(benchmark::State& state) {
  attention(state, false);
}
void both(benchmark::State& state) {
  attention(state, true);
}

void sizes(benchmark::internal::Benchmark* one) {
  for (const std::int64_t own : {1, 0}) {
    one->Args({8, 1024, 4, 48, own});  // configs/flat.json
    one->Args({4, 1024, 8, 64, own});  // the thesis's
    one->Args({8, 1024, 4, 32, own});  // the demo's
  }
  one->ArgNames({"B", "T", "H", "D", "own"})->UseRealTime()->Unit(benchmark::kMillisecond);
}

}  // namespace

BENCHMARK(forward)->Apply(sizes);
BENCHMARK(both)->Apply(sizes);
