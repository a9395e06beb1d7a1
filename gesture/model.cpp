#include "gesture/model.h"

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

std::size_t GestureModel::find(const std::string& phase) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < phases.size(); ++i) {
    if (phases[i].name == phase) return i;
    names.push_back(phases[i].name);
  }
  throw UsageError("the model has no phase \"" + phase + "\"" +
                   known_names(phase, names, "Phases"));
}

GestureModel fit_gesture(const Recordings& recordings, const GestureConfig& config) {
  return fit_gesture(cut_recordings(recordings, config), recordings, config);
}

GestureModel fit_gesture(const Cut& cut, const Recordings& recordings,
                         const GestureConfig& config) {
  GestureModel model;
  model.config = config;
  model.source = recordings.source;
  for (const PhaseDemonstrations& phase : cut.phases)
    model.phases.push_back(
        fit_phase(phase, recordings, config, phase_data(phase, recordings, config)));
  return model;
}

}  // namespace mocaplm
