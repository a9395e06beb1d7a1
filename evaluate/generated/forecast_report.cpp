#include "evaluate/generated/forecast_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/text.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

struct Published {
  const char* name;
  std::array<std::array<double, 4>, 4> values;  // metric, horizon
};

// Table 4.7 of the thesis, on AMASS; the first two as Aksan et al. (2021) have them.
const std::vector<Published>& published() {
  static const std::vector<Published> rows = {
      {"AMASS: zero velocity",
       {{{1.91, 5.93, 11.36, 17.78},
         {.37, 1.22, 2.44, 3.94},
         {.14, .48, .96, 1.54},
         {.86, .83, .84, .82}}}},
      {"AMASS: ST-Transformer",
       {{{1.11, 3.61, 7.31, 12.04},
         {.20, .68, 1.45, 2.48},
         {.08, .27, .57, .97},
         {.93, .90, .90, .88}}}},
      {"AMASS: thesis's LM, rate unknown",
       {{{1.01, 3.28, 5.97, 8.78},
         {.097, .295, .520, .761},
         {.200, .562, .943, 1.32},
         {.505, .399, .350, .354}}}},
  };
  return rows;
}

bool has(const std::vector<int>& joints, int joint) {
  return std::find(joints.begin(), joints.end(), joint) != joints.end();
}

void add_published(Table& table, const ForecastOptions& options, std::size_t metric) {
  const std::vector<double>& known = forecast_horizons();
  for (const Published& row : published()) {
    std::vector<Json> cells = {row.name};
    bool any = false;
    for (const double horizon : options.horizons) {
      const auto at = std::find(known.begin(), known.end(), horizon);
      any = any || at != known.end();
      cells.push_back(at == known.end() ? Json()
                                        : Json(row.values[metric][static_cast<std::size_t>(
                                              std::distance(known.begin(), at))]));
    }
    if (any) table.row(cells);
  }
}

std::string joint_list(const std::vector<int>& joints) {
  std::vector<std::string> names;
  for (const int joint : joints) names.push_back(joint_names()[static_cast<std::size_t>(joint)]);
  return join(names, ", ");
}

void tell_joints(Table& table, const ForecastOptions& options, const std::vector<int>& joints,
                 const std::vector<AskedModel>& models) {
  if (joints.size() < forecast_joints().size())
    table.note("- joints: " + std::to_string(joints.size()) + " of the 15, those that the " +
               "models have too (" + joint_list(joints) + "); the others are unmoved in forecast " +
               "and truth, so all rows change (--all-joints counts all 15)");
  if (!options.all_joints) return;
  for (const AskedModel& model : models) {
    std::vector<int> still;
    for (const int joint : joints)
      if (!has(model.generator->tokenizer().joints(), joint)) still.push_back(joint);
    if (!still.empty())
      table.note("- " + model.name + " lacks " + joint_list(still) +
                 ": these stay still in its forecasts");
  }
}

// What a reader must know before comparing with published figures.
void tell_differences(Table& table, const ForecastOptions& options,
                      const ForecastMaterial& material, const std::vector<int>& joints,
                      const std::vector<AskedModel>& models) {
  table.note(std::to_string(material.windows.size()) + " windows" +
             (material.windows.size() < material.found
                  ? " of " + std::to_string(material.found) + ", evenly drawn,"
                  : "") +
             " from " + std::to_string(material.clips) + " clips" +
             (material.short_clips > 0
                  ? " (" + std::to_string(material.short_clips) + " were too short)"
                  : ""));
  table.note(
      "Published: AMASS, 60 frames a second, 2 s seen, 100 to 400 ms ahead, 15 joints. "
      "Different here:");
  table.note("- data: " + options.data.string() + ", split " + options.split +
             "; proportions of SMPL's mean body");
  if (std::abs(options.fps - kForecastFps) > 1e-9)
    table.note("- rate: " + format_number(options.fps) +
               " frames a second; sums over the frames grow with the rate");
  if (material.slowest < options.fps - 1e-3)
    table.note("- some clips have " + format_number(material.slowest) +
               " frames a second: interpolated");
  for (const AskedModel& model : models)
    if (std::abs(model.fps() - options.fps) > 1e-9)
      table.note("- " + model.name + " sees and tells " + format_number(model.fps()) +
                 " frames a second: interpolated");
  if (std::abs(options.seed_seconds - kForecastSeedSeconds) > 1e-9)
    table.note("- seen: " + format_number(options.seed_seconds) + " s");
  for (const double horizon : options.horizons) {
    const double exact = horizon / 1000 * options.fps;
    if (std::abs(exact - std::round(exact)) > 1e-6)
      table.note("- " + format_number(horizon) + " ms are taken as " +
                 std::to_string(std::llround(exact)) + " frames");
  }
  if (options.horizons != forecast_horizons()) table.note("- horizons");
  tell_joints(table, options, joints, models);
}

}  // namespace

const std::array<ForecastMetric, 4>& forecast_metrics() {
  static const std::array<ForecastMetric, 4> all = {{
      {"Euler", "Euler angles: L2 norm in radians, summed over the frames; less is better",
       &ForecastScore::euler, false, 2},
      {"Joint angle", "Joint angle: global, mean of the joints in radians, summed; less is better",
       &ForecastScore::joint_angle, false, 3},
      {"Positional", "Positional: mean of the joints in thighs, summed; less is better",
       &ForecastScore::positional, false, 3},
      {"PCK (AUC)", "PCK: area under the curve, mean over the frames; more is better",
       &ForecastScore::auc, true, 3},
  }};
  return all;
}

std::vector<Table> forecast_report(const ForecastOptions& options, const ForecastMaterial& material,
                                   const std::vector<int>& joints,
                                   const std::vector<AskedModel>& models,
                                   const std::vector<ForecastRow>& rows) {
  std::vector<Table> tables;
  for (const ForecastMetric& metric : forecast_metrics()) {
    std::vector<std::string> columns = {metric.name};
    for (const double horizon : options.horizons) columns.push_back(format_number(horizon) + " ms");
    Table table(metric.title, columns);
    table.digits(std::vector<int>(columns.size(), metric.digits));
    for (const auto& [name, scores] : rows) {
      std::vector<Json> cells = {name};
      for (const ForecastScore& score : scores) cells.push_back(score.*metric.value);
      table.row(cells);
    }
    add_published(table, options, tables.size());
    tables.push_back(table);
  }
  tell_differences(tables.back(), options, material, joints, models);
  return tables;
}

}  // namespace mocaplm
