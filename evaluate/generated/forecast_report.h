// The tables of a forecast evaluation: scores beside the published ones, and what differs from the
// published protocol.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "common/table.h"
#include "evaluate/generated/forecast.h"

namespace mocaplm {

struct ForecastMetric {
  const char* name;
  const char* title;
  double ForecastScore::*value;
  bool more_is_better;
  int digits;
};
const std::array<ForecastMetric, 4>& forecast_metrics();

struct ForecastMaterial {
  std::vector<ForecastWindow> windows;
  std::size_t found = 0, clips = 0, short_clips = 0;
  double slowest = 0;  // rate of the source clips, at the least
};

// A method and its scores, one a horizon.
using ForecastScores = std::vector<ForecastScore>;
using ForecastRow = std::pair<std::string, ForecastScores>;

// One table a metric. `options.horizons` ascend; `joints` are those that count.
std::vector<Table> forecast_report(const ForecastOptions& options, const ForecastMaterial& material,
                                   const std::vector<int>& joints,
                                   const std::vector<AskedModel>& models,
                                   const std::vector<ForecastRow>& rows);

}  // namespace mocaplm
