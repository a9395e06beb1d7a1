// How a model is held for decoding.
#pragma once

#include <cstdint>

#include "generate/kernels/kernels.h"

namespace mocaplm {

constexpr std::int64_t kMaxSequences = kMaxRows;

struct EngineOptions {
  Precision precision = Precision::f32;
  int threads = 0;             // 0: one a core
  std::int64_t sequences = 1;  // that are decoded side by side, 1 to kMaxSequences
};

// Throws UsageError for a number of sequences outside its range.
const EngineOptions& checked(const EngineOptions& options);

// Mean distance of the logits over their spread that rounding to a precision may leave; 0 for f32.
double rounding_tolerance(Precision precision);

}  // namespace mocaplm
