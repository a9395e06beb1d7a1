// Forecasts of held-out clips by zero velocity, linear extrapolation and models, side by side.
#pragma once

#include <vector>

#include "common/table.h"
#include "evaluate/generated/asked_models.h"
#include "evaluate/generated/forecast_metrics.h"
#include "evaluate/generated/forecast_windows.h"

namespace mocaplm {

struct ForecastOptions : GeneratedOptions {
  double fps = kForecastFps;                           // at which is shown and compared
  std::vector<double> horizons = forecast_horizons();  // milliseconds
  std::int64_t samples = 8;                            // beside the greedy forecast
  std::int64_t windows = 0;                            // evenly drawn from all, 0: all
  bool all_joints = false;  // the protocol's joints that a model lacks stay still
};

// One table for each of the four metrics: methods down, horizons across; the notes say what differs
// from the published protocol. Without models the two simple forecasts. Throws UsageError for
// horizons of less than a frame, DataError when no clip is long enough, and for unsound models.
std::vector<Table> forecast_tables(const ForecastOptions& options);

// A forecast of `frames` frames at the seed's rate from a model's answer to model_request.
GenerateRequest model_request(const Clip& seed, Eigen::Index frames, const Generator& generator);
// Joints that the model lacks are as in the seed's last frame.
Clip model_forecast(const Clip& seed, Eigen::Index frames, const GenerateResult& result,
                    const Generator& generator);

}  // namespace mocaplm
