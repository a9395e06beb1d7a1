#include "model/transformer/dropout.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <cstdint>

namespace mocaplm {

namespace {

// SplitMix64 (Steele, Lea, Flood 2014): a hash of the index, so that any thread can draw any
// element.
std::uint64_t hashed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// Four elements share one hash, 16 bits each.
template <class Value>
void fill(Value* values, std::int64_t count, double p, std::uint64_t seed) {
  const auto threshold = static_cast<std::uint64_t>(p * 65536);
  const auto kept = static_cast<Value>(1 / (1 - static_cast<double>(threshold) / 65536));
  at::parallel_for(0, (count + 3) / 4, 1 << 14, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const std::uint64_t bits = hashed(seed + static_cast<std::uint64_t>(i));
      const std::int64_t last = std::min<std::int64_t>(4, count - 4 * i);
      for (std::int64_t j = 0; j < last; ++j)
        values[4 * i + j] =
            (bits >> (16 * j) & 0xFFFF) < threshold ? static_cast<Value>(0.f) : kept;
    }
  });
}

}  // namespace

std::uint64_t random_seed() {
  return static_cast<std::uint64_t>(at::randint(INT64_MAX, {1}, at::kLong).item<std::int64_t>());
}

at::Tensor dropout_mask(const at::Tensor& like, double p) {
  at::Tensor mask = at::empty_like(like, at::MemoryFormat::Contiguous);
  if (!mask.device().is_cpu()) return mask.bernoulli_(1 - p).div_(1 - p);
  const std::uint64_t seed = random_seed();
  if (mask.scalar_type() == at::kBFloat16)
    fill(mask.data_ptr<at::BFloat16>(), mask.numel(), p, seed);
  else
    fill(mask.data_ptr<float>(), mask.numel(), p, seed);
  return mask;
}

}  // namespace mocaplm
