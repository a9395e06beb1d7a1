// A gesture model: its phases in order, on disk as one JSON file.
//
//   {"format": "mocaplm gesture", "version": 1, "settings": {GestureConfig}, "source": "toss.csv",
//    "phases": [{"name": "toss", "rule": "v_y < 0", "coordinates": ["x", "y"],
//                "conditions": ["start", "end"], "harmonics": 10, "dof": 35, "rank": 5,
//                "f": [[...]],                F, (V * M, k + 1)
//                "covariance": [[...]],       (V * M, M)
//                "gram_inverse": [[...]],     (k + 1, k + 1)
//                "truncation": [...],         (V)
//                "demonstrations": [{"name": "7", "duration": 0.4, "start": [...], "end": [...],
//                                    "more": [...]}]}]}
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/json.h"
#include "gesture/phase_model.h"

namespace mocaplm {

struct GestureModel {
  GestureConfig config;
  std::string source;  // what it was made from
  std::vector<PhaseModel> phases;

  // Index of a phase; UsageError with the nearest name.
  std::size_t find(const std::string& phase) const;
};

// Cuts, expands and regresses. Throws what cut_recordings, phase_data and fit_phase throw.
GestureModel fit_gesture(const Recordings& recordings, const GestureConfig& config);
// The same from pieces that are cut already.
GestureModel fit_gesture(const Cut& cut, const Recordings& recordings, const GestureConfig& config);

Json gesture_json(const GestureModel& model);
// Throws DataError naming `place` and the key for what is not such a model: unknown keys, sizes
// that do not agree, numbers that are not finite, a rule that cannot be read, a negative variance.
GestureModel gesture_from_json(const Json& json, const std::string& place);

void save_gesture(const std::filesystem::path& path, const GestureModel& model);
GestureModel load_gesture(const std::filesystem::path& path);

}  // namespace mocaplm
