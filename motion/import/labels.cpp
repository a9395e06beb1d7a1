#include "motion/import/labels.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/csv.h"
#include "common/error.h"
#include "common/pattern.h"
#include "common/text.h"
#include "motion/formats/aist.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// A table whose rows belong to files.
struct FileTable {
  Csv csv;
  PathList paths;
  std::size_t key = 0;
  std::vector<bool> used;

  explicit FileTable(const std::string& file) : csv(read_csv(file)) {
    key = csv.find("file") >= 0 || csv.find("name") < 0 ? csv.column("file") : csv.column("name");
    for (std::size_t row = 0; row < csv.rows.size(); ++row)
      paths.add(csv.rows[row][key], csv.file, csv.lines[row]);
    used.resize(csv.rows.size());
  }

  std::optional<std::size_t> row_of(const SourceFile& source) {
    const std::optional<std::size_t> row = paths.find(source);
    if (row) used[*row] = true;
    return row;
  }

  void warn(std::size_t without, std::vector<std::string>& warnings) const {
    const auto unused = std::count(used.begin(), used.end(), false);
    if (without > 0)
      warnings.push_back(csv.file + " has no row for " + std::to_string(without) + " of the files");
    if (unused > 0)
      warnings.push_back(csv.file + ": " + std::to_string(unused) +
                         " rows belong to none of the files");
  }
};

double number_in(const FileTable& table, std::size_t row, std::size_t column, double min,
                 double max) {
  const std::string& cell = table.csv.rows[row][column];
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value) ||
      value < min || value > max)
    throw DataError(at_line(table.csv.file, table.csv.lines[row]),
                    "\"" + table.csv.columns[column] + "\" is \"" + cell +
                        "\", expected a number from " + format_number(min) + " to " +
                        format_number(max));
  return value;
}

// Columns that become labels.
std::vector<std::size_t> label_columns(const ImportConfig& config, const FileTable& table) {
  std::vector<std::size_t> columns;
  if (config.csv_labels == std::vector<std::string>{"none"}) return columns;
  for (const std::string& name : config.csv_labels) columns.push_back(table.csv.column(name));
  if (!config.csv_labels.empty()) return columns;
  for (std::size_t c = 0; c < table.csv.columns.size(); ++c) {
    const std::string& name = table.csv.columns[c];
    if (c != table.key && name != config.csv_fps && name != config.csv_drop_first)
      columns.push_back(c);
  }
  return columns;
}

void use_label_csv(const ImportConfig& config, const std::vector<SourceFile>& sources,
                   Facts& facts) {
  FileTable table(config.label_csv);
  const std::vector<std::size_t> columns = label_columns(config, table);
  std::optional<std::size_t> fps, drop;
  if (!config.csv_fps.empty()) fps = table.csv.column(config.csv_fps);
  if (!config.csv_drop_first.empty()) drop = table.csv.column(config.csv_drop_first);
  std::size_t without = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::optional<std::size_t> row = table.row_of(sources[i]);
    if (!row) {
      ++without;
      continue;
    }
    FileFacts& file = facts.files[i];
    const std::vector<std::string>& cells = table.csv.rows[*row];
    for (const std::size_t c : columns)
      if (!cells[c].empty()) file.labels[table.csv.columns[c]] = cells[c];
    if (fps && !cells[*fps].empty()) file.fps = number_in(table, *row, *fps, 0.001, 10000);
    if (drop && !cells[*drop].empty())
      file.drop_first = static_cast<std::int64_t>(number_in(table, *row, *drop, 0, 1e6));
  }
  table.warn(without, facts.warnings);
}

// With a '/' an expression speaks of the path, otherwise of the file's name.
std::string searched_text(const std::string& expression, const SourceFile& source) {
  return expression.find('/') == std::string::npos ? source.path.filename().string() : source.below;
}

void use_label_regex(const ImportConfig& config, const std::vector<SourceFile>& sources,
                     Facts& facts) {
  const Pattern pattern(config.label_regex, "--label-regex");
  if (pattern.names().empty())
    throw UsageError(
        "--label-regex has no named group; name what is to become a label: (?<style>[a-z]+)");
  std::size_t without = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto match = pattern.search(searched_text(config.label_regex, sources[i]));
    if (!match) {
      ++without;
      continue;
    }
    for (const auto& [name, value] : match->named)
      if (!value.empty()) facts.files[i].labels[name] = value;
  }
  if (without > 0)
    facts.warnings.push_back("--label-regex does not match " + std::to_string(without) +
                             " of the files");
}

void use_group_csv(const ImportConfig& config, const std::vector<SourceFile>& sources,
                   Facts& facts) {
  FileTable table(config.group);
  const std::size_t column = table.csv.column("group");
  std::size_t without = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::optional<std::size_t> row = table.row_of(sources[i]);
    if (row)
      facts.files[i].group = table.csv.rows[*row][column];
    else
      ++without;
  }
  table.warn(without, facts.warnings);
}

void use_group_regex(const ImportConfig& config, const std::vector<SourceFile>& sources,
                     Facts& facts) {
  const Pattern pattern(config.group, "--group");
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (const auto match = pattern.search(searched_text(config.group, sources[i])))
      facts.files[i].group = match->groups.empty() ? match->whole : join(match->groups, "_");
}

}  // namespace

Facts gather_facts(const ImportConfig& config, const std::vector<SourceFile>& sources) {
  if (config.label_csv.empty() &&
      (!config.csv_labels.empty() || !config.csv_fps.empty() || !config.csv_drop_first.empty()))
    throw UsageError("--csv-labels, --csv-fps and --csv-drop-first need --label-csv FILE");
  Facts facts;
  for (const SourceFile& source : sources) {
    FileFacts file;
    // Pieces of one AIST++ dance, and its views by other cameras, are never separated.
    if (const auto name = parse_aist_name(source.path.stem().string())) {
      file.labels = name->labels;
      file.group = name->dance;
    }
    if (!config.label_from_dir.empty()) file.labels[config.label_from_dir] = source.folder();
    if (config.fps > 0) file.fps = config.fps;
    file.drop_first = config.drop_first;
    facts.files.push_back(file);
  }
  if (!config.label_regex.empty()) use_label_regex(config, sources, facts);
  if (!config.label_csv.empty()) use_label_csv(config, sources, facts);
  if (!config.group.empty()) {
    if (fs::is_regular_file(config.group))
      use_group_csv(config, sources, facts);
    else
      use_group_regex(config, sources, facts);
  }
  return facts;
}

}  // namespace mocaplm
