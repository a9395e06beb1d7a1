#include "generate/options.h"

#include <string>

#include "common/error.h"

namespace mocaplm {

const EngineOptions& checked(const EngineOptions& options) {
  if (options.sequences < 1 || options.sequences > kMaxSequences)
    throw UsageError("an engine decodes 1 to " + std::to_string(kMaxSequences) +
                     " sequences at once");
  return options;
}

double rounding_tolerance(Precision precision) {
  return precision == Precision::int8 ? 0.15 : precision == Precision::bf16 ? 0.05 : 0;
}

}  // namespace mocaplm
