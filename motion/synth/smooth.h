// Smoothing in time; both ends are continued with their own value.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace mocaplm {

// Weights that sum to one, of a bell that ends after 3 sigma (frames).
std::vector<double> bell(double sigma);

// Any type with + and multiplication by a number from the left.
template <class Value>
std::vector<Value> smoothed(const std::vector<Value>& values, const std::vector<double>& kernel) {
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(values.size());
  const std::ptrdiff_t half = static_cast<std::ptrdiff_t>(kernel.size() / 2);
  std::vector<Value> out;
  out.reserve(values.size());
  for (std::ptrdiff_t t = 0; t < count; ++t) {
    const auto at = [&](std::ptrdiff_t k) {
      return values[static_cast<std::size_t>(std::clamp(t + k, std::ptrdiff_t{0}, count - 1))];
    };
    Value sum = kernel[0] * at(-half);
    for (std::ptrdiff_t k = -half + 1; k <= half; ++k)
      sum = sum + kernel[static_cast<std::size_t>(k + half)] * at(k);
    out.push_back(sum);
  }
  return out;
}

Eigen::VectorXd smoothed(const Eigen::VectorXd& values, const std::vector<double>& kernel);

// A smooth curve that is nowhere under `values`: the largest within the kernel's reach, smoothed.
Eigen::VectorXd cover(const Eigen::VectorXd& values, const std::vector<double>& kernel);

}  // namespace mocaplm
