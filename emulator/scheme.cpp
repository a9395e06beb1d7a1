#include "emulator/scheme.h"

#include <algorithm>

#include "common/error.h"
#include "common/text.h"
#include "emulator/coefficients.h"
#include "emulator/reduction.h"
#include "emulator/representation.h"

namespace mocaplm {

namespace {

void check_part(const std::string& scheme, const std::string& what, const std::string& name,
                const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw UsageError("scheme " + scheme + ": unknown " + what + " \"" + name + "\"" +
                     known_names(name, known));
}

}  // namespace

Scheme parse_scheme(const std::string& name) {
  if (name == "PWI") return {"PWI", "", ""};
  const std::vector<std::string> parts = split(name, '/');
  if (parts.size() != 3)
    throw UsageError("scheme \"" + name +
                     "\": expected Representation/DimensionReduction/Model, as in "
                     "SIEM/SequentialPCA/MVG, or PWI");
  std::vector<std::string> models = coefficient_model_names();
  models.push_back("VAR");
  check_part(name, "representation", parts[0], representation_names());
  check_part(name, "reduction", parts[1], reduction_names());
  check_part(name, "model", parts[2], models);
  if ((parts[2] == "VAR") != (parts[1] == "SpatialPCA"))
    throw UsageError("scheme " + name +
                     ": VAR is a model of courses in time, which SpatialPCA leaves and the other "
                     "reductions do not: SpatialPCA/VAR go together");
  return {parts[0], parts[1], parts[2]};
}

std::string to_string(const Scheme& scheme) {
  return scheme.representation == "PWI"
             ? "PWI"
             : scheme.representation + "/" + scheme.reduction + "/" + scheme.model;
}

}  // namespace mocaplm
