// Random numbers that repeat exactly on every machine: the standard library's distributions do not.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace mocaplm {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  // Uniform in [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Uniform whole number in [0, n); n > 0.
  std::uint64_t below(std::uint64_t n);
  // Standard normal (Box and Muller's transform).
  double normal();

  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(i)]);
  }

  // The whole state as text, and back: a resumed run continues the same stream.
  std::string state() const;
  void set_state(const std::string& state);

 private:
  std::mt19937_64 engine_;
};

// A 64-bit hash of text that is the same everywhere (FNV-1a with a final mix), for seeds and
// fingerprints.
std::uint64_t stable_hash(const std::string& text, std::uint64_t seed = 0);
std::string hex(std::uint64_t value);

}  // namespace mocaplm
