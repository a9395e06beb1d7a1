#include "numeric/histogram.h"

#include <cassert>
#include <cmath>

namespace mocaplm {

Histogram::Histogram(int size, double smoothing)
    : counts_(static_cast<std::size_t>(size)), smoothing_(smoothing) {
  assert(size > 0 && smoothing > 0);
}

void Histogram::add(int value) {
  assert(value >= 0 && value < size());
  ++counts_[static_cast<std::size_t>(value)];
  ++total_;
}

double Histogram::probability(int value) const {
  assert(value >= 0 && value < size());
  return (static_cast<double>(count(value)) + smoothing_) /
         (static_cast<double>(total_) + smoothing_ * size());
}

double Histogram::bits(int value) const {
  return -std::log2(probability(value));
}

}  // namespace mocaplm
