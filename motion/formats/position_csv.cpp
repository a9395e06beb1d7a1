#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/joint_csv.h"
#include "motion/formats/position_rate.h"
#include "motion/formats/position_text.h"
#include "motion/formats/positions.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxColumns = 4096;

char delimiter_of(std::string_view header) {
  for (const char c : {',', ';', '\t'})
    if (header.find(c) != std::string_view::npos) return c;
  return ',';
}

struct Column {
  std::string name;  // of the joint
  int axis = -1;     // 0 x, 1 y, 2 z
};

// "left_hip_x", "LHip.X", "LHip X", "LHipX", "Subject:LHip-x".
Column column_of(std::string_view cell) {
  if (cell.size() < 2) return {};
  const char letter = cell.back(), before = cell[cell.size() - 2];
  const std::size_t axis = std::string("xyzXYZ").find(letter);
  if (axis == std::string::npos) return {};
  const bool is_separator = std::string("_.-: ").find(before) != std::string::npos;
  const bool is_capital =
      axis >= 3 && ((before >= 'a' && before <= 'z') || (before >= '0' && before <= '9'));
  if (!is_separator && !is_capital) return {};
  const std::string name(cell.substr(0, cell.size() - (is_separator ? 2 : 1)));
  return name.empty() ? Column() : Column{name, static_cast<int>(axis % 3)};
}

struct Header {
  char delimiter = ',';
  std::size_t cells = 0;
  int time = -1;       // column, or -1
  double seconds = 1;  // of a unit of `time`
  std::vector<std::string> names;
  std::vector<std::array<int, 3>> columns;  // of each name
};

Header header_of(std::string_view line) {
  Header header;
  header.delimiter = delimiter_of(line);
  const std::vector<std::string_view> cells = text_cells(line, header.delimiter);
  header.cells = cells.size();
  if (cells.size() > kMaxColumns) return header;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string word = lower(std::string(cells[i]));
    for (const auto& [name, seconds] : {std::pair<const char*, double>{"time", 1},
                                        {"t", 1},
                                        {"timestamp", 1},
                                        {"seconds", 1},
                                        {"time (s)", 1},
                                        {"time_s", 1},
                                        {"time_ms", 1e-3},
                                        {"time (ms)", 1e-3}})
      if (word == name && header.time < 0) {
        header.time = static_cast<int>(i);
        header.seconds = seconds;
      }
    const Column column = column_of(cells[i]);
    if (column.axis < 0) continue;
    const auto found = std::find(header.names.begin(), header.names.end(), column.name);
    const auto at = static_cast<std::size_t>(found - header.names.begin());
    if (found == header.names.end()) {
      header.names.push_back(column.name);
      header.columns.push_back({-1, -1, -1});
    }
    int& slot = header.columns[at][static_cast<std::size_t>(column.axis)];
    if (slot < 0) slot = static_cast<int>(i);
  }
  for (std::size_t i = header.names.size(); i-- > 0;) {
    if (*std::min_element(header.columns[i].begin(), header.columns[i].end()) >= 0) continue;
    header.names.erase(header.names.begin() + static_cast<std::ptrdiff_t>(i));
    header.columns.erase(header.columns.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return header;
}

// The header that this program writes.
bool is_ours(const Header& header, std::string_view line) {
  return header.names.size() == kJoints && line.substr(0, 11) == "frame,time," &&
         std::equal(header.names.begin(), header.names.end(), joint_names().begin());
}

}  // namespace

std::vector<std::string> position_columns(const std::string& header) {
  TextLines lines(header);
  std::string_view line;
  return lines.next(line) ? header_of(line).names : std::vector<std::string>();
}

PositionTable read_position_csv(const std::string& text, const std::string& file) {
  TextLines lines(text);
  std::string_view line;
  if (!lines.next(line)) throw DataError(in_file(file), "is empty");
  const Header header = header_of(line);
  if (header.names.empty())
    throw DataError(at_line(file, 1),
                    "is no header of joint positions, expected frame,time,pelvis_x,pelvis_y,"
                    "pelvis_z,left_hip_x,... with three columns a joint");
  PositionTable table;
  table.file = file;
  table.names = header.names;
  if (is_ours(header, line)) {
    table.y_up = true;
    table.unit = 1;
  }
  std::vector<double> values, times;
  int decimals = 0;
  while (lines.next(line)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    const std::vector<std::string_view> cells = text_cells(line, header.delimiter);
    if (cells.size() != header.cells)
      throw DataError(at_line(file, lines.number()), "has " + std::to_string(cells.size()) +
                                                         " cells, but the header has " +
                                                         std::to_string(header.cells));
    if (header.time >= 0) {
      const std::string_view time = cells[static_cast<std::size_t>(header.time)];
      times.push_back(header.seconds * cell_number(time, file, lines.number()));
      decimals = std::max(decimals, cell_decimals(time) + (header.seconds < 1 ? 3 : 0));
    }
    for (const auto& columns : header.columns)
      for (const int column : columns)
        values.push_back(
            cell_number(cells[static_cast<std::size_t>(column)], file, lines.number()));
    if (values.size() / (3 * header.names.size()) > kMaxClipFrames)
      throw DataError(at_line(file, lines.number()),
                      "has more than " + std::to_string(kMaxClipFrames) + " frames");
  }
  const auto width = static_cast<Eigen::Index>(3 * header.names.size());
  const Eigen::Index frames = static_cast<Eigen::Index>(values.size()) / width;
  if (frames == 0) throw DataError(in_file(file), "has a header, but no frames");
  table.places = Eigen::Map<const decltype(table.places)>(values.data(), frames, width);
  table.fps = rate_of_times(times, decimals, file, table.remarks);
  return table;
}

}  // namespace mocaplm
