#include "common/random.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "common/angles.h"
#include "common/error.h"

namespace mocaplm {

std::uint64_t Random::below(std::uint64_t n) {
  // Rejection keeps every value equally likely.
  const std::uint64_t limit = UINT64_MAX - UINT64_MAX % n;
  std::uint64_t value = engine_();
  while (value >= limit) value = engine_();
  return value % n;
}

double Random::normal() {
  const double u = 1.0 - uniform();
  const double v = uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(kTurn * v);
}

std::string Random::state() const {
  std::ostringstream out;
  out << engine_;
  return out.str();
}

void Random::set_state(const std::string& state) {
  std::istringstream in(state);
  in >> engine_;
  if (!in) throw Error(ExitCode::data, "the saved state of the random numbers is damaged");
}

std::uint64_t stable_hash(const std::string& text, std::uint64_t seed) {
  std::uint64_t hash = 0xcbf29ce484222325ULL ^ (seed * 0x9e3779b97f4a7c15ULL);
  for (const unsigned char c : text) hash = (hash ^ c) * 0x100000001b3ULL;
  hash ^= hash >> 33;
  hash *= 0xff51afd7ed558ccdULL;
  hash ^= hash >> 33;
  return hash;
}

std::string hex(std::uint64_t value) {
  char buffer[20];
  std::snprintf(buffer, sizeof buffer, "%016llx", static_cast<unsigned long long>(value));
  return buffer;
}

}  // namespace mocaplm
