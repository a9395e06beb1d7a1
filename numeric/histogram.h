// Counts of whole numbers 0 .. size-1, and the code length that they give.
#pragma once

#include <cstdint>
#include <vector>

namespace mocaplm {

class Histogram {
 public:
  // Additive smoothing (Lidstone): every value counts `smoothing` > 0 times before anything is
  // seen.
  explicit Histogram(int size, double smoothing = 1);

  void add(int value);
  int size() const { return static_cast<int>(counts_.size()); }
  std::int64_t total() const { return total_; }
  std::int64_t count(int value) const { return counts_[static_cast<std::size_t>(value)]; }
  // (count + smoothing) / (total + size * smoothing); these sum to 1.
  double probability(int value) const;
  // -log2 of the probability.
  double bits(int value) const;

 private:
  std::vector<std::int64_t> counts_;
  std::int64_t total_ = 0;
  double smoothing_;
};

}  // namespace mocaplm
