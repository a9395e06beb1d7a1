// What is known of a finished row; kept as result.json beside its model.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/json.h"

namespace mocaplm {

// Accuracy of windows, shares of 1.
struct MethodAccuracy {
  std::string method;  // "Majority class", "LDA", "Transformer"
  std::vector<std::pair<std::string, double>> labels;
};

struct RowResult {
  std::string name, line, column;
  // Of the stream that the model speaks.
  double fps = 0;
  std::int64_t bins = 0;
  std::string binning;
  std::vector<int> joints;
  // Held-out clips: mean bits of a frame, a channel each, the separator last; the same of the
  // baseline of order 2, without the separator.
  std::vector<double> bits, order_2;
  std::int64_t frames = 0;
  std::int64_t predicted = 0;  // tokens of a frame that have a loss
  bool masked = false;
  std::int64_t parameters = 0, steps = 0;
  double minutes = 0;                    // of training
  std::vector<MethodAccuracy> accuracy;  // classification only; then there are no bits

  std::int64_t rotations() const { return 3 * static_cast<std::int64_t>(joints.size()); }
};

Json to_json(const RowResult& result);
// Throws DataError when it is not one.
RowResult result_from_json(const Json& json, const std::string& place);

}  // namespace mocaplm
