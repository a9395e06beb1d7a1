// Which attention weights dropout sets to 0: a hash of (seed, head, query, key), so that forward
// and backward, and any number of threads, agree without storing a mask.
#pragma once

#include <cstdint>

namespace mocaplm::cpu {

constexpr std::uint32_t kKeyStep = 0x9e3779b9U;
constexpr std::uint32_t kMix1 = 0x7feb352dU, kMix2 = 0x846ca68bU;  // "lowbias32" (Wellons 2018)
constexpr int kHashBits = 24;                                      // that decide

// Seed of one query's weights, one `pair` a (batch, head).
inline std::uint32_t row_seed(std::uint64_t seed, std::int64_t pair, std::int64_t t) {
  std::uint64_t x = seed + (static_cast<std::uint64_t>(pair) << 32) + static_cast<std::uint64_t>(t);
  x += 0x9e3779b97f4a7c15ULL;  // SplitMix64 (Steele, Lea, Flood 2014)
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<std::uint32_t>(x >> 32);
}

inline std::uint32_t weight_hash(std::uint32_t row, std::int64_t s) {
  std::uint32_t x = row + kKeyStep * static_cast<std::uint32_t>(s);
  x = (x ^ (x >> 16)) * kMix1;
  x = (x ^ (x >> 15)) * kMix2;
  return (x ^ (x >> 16)) >> (32 - kHashBits);
}

// Hashes below this are dropped.
inline std::uint32_t drop_below(double p) {
  return static_cast<std::uint32_t>(p * (1 << kHashBits));
}

}  // namespace mocaplm::cpu
