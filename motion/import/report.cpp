#include <map>
#include <set>

#include "common/text.h"
#include "motion/import.h"

namespace mocaplm {

namespace {

constexpr std::size_t kShownValues = 12;

std::string rates_of(const std::vector<DatasetEntry>& entries) {
  std::map<double, int> clips;
  for (const DatasetEntry& entry : entries) ++clips[entry.fps];
  std::vector<std::string> rates;
  for (const auto& [fps, count] : clips)
    if (rates.size() < 6) rates.push_back(format_number(fps) + " (" + std::to_string(count) + ")");
  return join(rates, ", ") + (clips.size() > 6 ? ", ..." : "");
}

void add_split_row(Table& table, const std::string& name,
                   const std::vector<DatasetEntry>& entries) {
  double seconds = 0;
  std::int64_t frames = 0;
  std::set<std::string> groups;
  for (const DatasetEntry& entry : entries) {
    seconds += entry.seconds();
    frames += entry.frames;
    groups.insert(entry.group);
  }
  table.row({name, entries.size(), groups.size(), frames, seconds / 60, rates_of(entries)});
}

}  // namespace

Table split_table(const Dataset& dataset) {
  Table table(
      dataset.procedural ? "Procedural dances (made by rules, nobody danced them)" : "Clips",
      {"split", "clips", "groups", "frames", "minutes", "frames per second (clips)"});
  table.digits({-1, -1, -1, -1, 1, -1});
  for (const std::string& name : split_names()) add_split_row(table, name, dataset.split(name));
  add_split_row(table, "all", dataset.entries);
  return table;
}

Table label_table(const Dataset& dataset) {
  Table table("Labels", {"label", "clips", "values"});
  for (const std::string& label : dataset.label_names()) {
    std::map<std::string, int> clips;
    std::size_t labelled = 0;
    for (const DatasetEntry& entry : dataset.entries) {
      const auto found = entry.labels.find(label);
      if (found == entry.labels.end()) continue;
      ++labelled;
      ++clips[found->second];
    }
    std::vector<std::string> values;
    for (const auto& [value, count] : clips)
      if (values.size() < kShownValues)
        values.push_back(value + " (" + std::to_string(count) + ")");
    table.row({label, labelled, clips.size()});
    table.note(label + ": " + join(values, ", ") + (clips.size() > kShownValues ? ", ..." : ""));
  }
  return table;
}

std::vector<std::string> left_out_lines(const ImportReport& report) {
  Troubles troubles;
  for (const BrokenFile& file : report.broken)
    troubles.add({file.file, {kind_of_error(file.reason, file.file), file.reason}});
  return troubles.error_lines();
}

std::vector<std::string> remark_lines(const ImportReport& report) {
  Troubles troubles;
  for (const FileRemark& remark : report.remarks) troubles.add(remark);
  return troubles.lines();
}

Json report_json(const ImportReport& report) {
  Json broken = Json::array();
  for (const BrokenFile& file : report.broken)
    broken.push_back(Json{{"file", file.file}, {"reason", file.reason}});
  Json remarks = Json::array();
  for (const FileRemark& file : report.remarks)
    remarks.push_back(
        Json{{"file", file.file}, {"kind", file.remark.kind}, {"text", file.remark.text}});
  Json json{{"imported", report.imported},
            {"ignored", report.ignored},
            {"broken", broken},
            {"remarks", remarks},
            {"duplicates", report.duplicates},
            {"warnings", report.warnings},
            {"splits", split_table(report.dataset).json()},
            {"labels", label_table(report.dataset).json()}};
  if (!report.limbs.empty()) {
    json["limbs"] = report.limbs.table().json();
    json["limb_error_degrees"] = report.limbs.mean_degrees();
  }
  if (!report.figures.empty()) json["figures"] = report.figures.table().json();
  return json;
}

}  // namespace mocaplm
