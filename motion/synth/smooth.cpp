#include "motion/synth/smooth.h"

#include <cmath>

namespace mocaplm {

std::vector<double> bell(double sigma) {
  const int half = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<double> kernel;
  double sum = 0;
  for (int k = -half; k <= half; ++k) {
    kernel.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += kernel.back();
  }
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

Eigen::VectorXd smoothed(const Eigen::VectorXd& values, const std::vector<double>& kernel) {
  const std::vector<double> out =
      smoothed(std::vector<double>(values.data(), values.data() + values.size()), kernel);
  return Eigen::Map<const Eigen::VectorXd>(out.data(), values.size());
}

Eigen::VectorXd cover(const Eigen::VectorXd& values, const std::vector<double>& kernel) {
  const Eigen::Index half = static_cast<Eigen::Index>(kernel.size() / 2), count = values.size();
  Eigen::VectorXd largest(count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Index first = std::max<Eigen::Index>(0, t - half);
    const Eigen::Index last = std::min(count - 1, t + half);
    largest(t) = values.segment(first, last - first + 1).maxCoeff();
  }
  return smoothed(largest, kernel);
}

}  // namespace mocaplm
