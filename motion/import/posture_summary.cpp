#include "motion/import/posture_summary.h"

#include <functional>
#include <optional>

namespace mocaplm {

void PostureSummary::add(const std::string& clip, const BodyPosture& posture,
                         const RetargetReport& report) {
  clips_.push_back({clip, posture, report.unit, report.height});
}

Table PostureSummary::table() const {
  struct Measure {
    const char* name;
    std::function<std::optional<double>(const Row&)> value;
  };
  const auto known = [](double value) { return value > 0 ? std::optional(value) : std::nullopt; };
  const std::vector<Measure> measures = {
      {"trunk from the vertical, degrees", [](const Row& r) { return r.posture.lean; }},
      {"hips against shoulders, degrees", [](const Row& r) { return r.posture.twist; }},
      {"face against chest, degrees", [](const Row& r) { return r.posture.head_turn; }},
      {"left foot against hips, degrees", [](const Row& r) { return r.posture.feet_turn[0]; }},
      {"right foot against hips, degrees", [](const Row& r) { return r.posture.feet_turn[1]; }},
      {"sole to crown, m", [](const Row& r) { return r.posture.height; }},
      {"lowest foot joint, m", [](const Row& r) { return r.posture.lowest_foot; }},
      {"planted feet slide, cm/s", [](const Row& r) { return r.posture.slide; }},
      {"source: ankles to head, m", [&](const Row& r) { return known(r.size); }},
      {"source: metres a unit", [&](const Row& r) { return known(r.unit); }}};
  Table table("Figures", {"measure", "mean", "smallest", "in clip", "largest", "in clip"});
  for (const Measure& measure : measures) {
    double sum = 0;
    std::size_t count = 0;
    const Row *least = nullptr, *most = nullptr;
    for (const Row& row : clips_) {
      const std::optional<double> value = measure.value(row);
      if (!value) continue;
      sum += *value;
      ++count;
      if (least == nullptr || *value < *measure.value(*least)) least = &row;
      if (most == nullptr || *value > *measure.value(*most)) most = &row;
    }
    if (count == 0) continue;
    table.row({measure.name, sum / static_cast<double>(count), *measure.value(*least), least->clip,
               *measure.value(*most), most->clip});
  }
  table.note("At most " + std::to_string(kPostureFrames) + " frames of each clip are looked at.");
  return table;
}

}  // namespace mocaplm
