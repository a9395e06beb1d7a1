// The tracks of markers of Motion Analysis' .trc, as OpenSim documents it: tabs between cells,
//
//   PathFileType  4  (X/Y/Z)  walk.trc
//   DataRate  CameraRate  NumFrames  NumMarkers  Units  OrigDataRate  ...
//   60        60          120        22          m      60            ...
//   Frame#  Time  Hip  (two empty)  RHip  ...
//                 X1  Y1  Z1        X2    ...
//   1  0.000  0.01  0.93  ...
//
// What stands there are joints, by the names, or markers on the skin, which are refused.
#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/position_rate.h"
#include "motion/formats/position_text.h"
#include "motion/formats/positions.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxMarkers = 2000;

class TrcReader {
 public:
  TrcReader(const std::string& text, const std::string& file) : lines_(text), file_(file) {
    table_.file = file;
  }

  PositionTable read() {
    read_head();
    read_names();
    read_frames();
    return std::move(table_);
  }

 private:
  // The next line that is not empty.
  std::string_view line(const char* expected) {
    std::string_view line;
    while (lines_.next(line))
      if (line.find_first_not_of(" \t") != std::string_view::npos) return line;
    throw DataError(at_line(file_, lines_.number()),
                    std::string("ends before ") + expected + " of a .trc file");
  }

  void read_head() {
    const std::string_view first = line("the first line");
    if (lower(std::string(first.substr(0, 12))) != "pathfiletype")
      throw DataError(at_line(file_, lines_.number()),
                      "is no .trc file: it does not begin with PathFileType");
    const std::vector<std::string_view> keys = text_cells(line("the header's names"), '\t'),
                                        values = text_cells(line("the header's values"), '\t');
    const std::size_t at = lines_.number();
    for (std::size_t i = 0; i < std::min(keys.size(), values.size()); ++i) {
      const std::string key = lower(std::string(keys[i]));
      if (key == "datarate") rate_ = cell_number(values[i], file_, at);
      if (key == "numframes") announced_frames_ = cell_number(values[i], file_, at);
      if (key == "nummarkers") announced_markers_ = cell_number(values[i], file_, at);
      if (key == "units") set_unit(std::string(values[i]));
    }
  }

  void set_unit(const std::string& text) {
    const std::string unit = lower(text);
    for (const auto& [name, metres] : {std::pair<const char*, double>{"m", 1},
                                       {"meters", 1},
                                       {"metres", 1},
                                       {"dm", 0.1},
                                       {"cm", 0.01},
                                       {"mm", 0.001},
                                       {"in", 0.0254},
                                       {"inches", 0.0254}})
      if (unit == name) table_.unit = metres;
    if (!table_.unit)
      table_.remarks.push_back({"unit", "the unit \"" + text.substr(0, 20) + "\" is not known"});
  }

  void read_names() {
    const std::vector<std::string_view> cells = text_cells(line("the markers' names"), '\t');
    const std::size_t at = lines_.number();
    if (cells.size() < 3 || lower(std::string(cells[0])).substr(0, 5) != "frame")
      throw DataError(at_line(file_, at),
                      "is not the line of names, expected Frame#, Time and the markers'");
    for (std::size_t i = 2; i < cells.size(); ++i)
      if (!cells[i].empty()) table_.names.emplace_back(cells[i]);
    if (table_.names.empty() || table_.names.size() > kMaxMarkers)
      throw DataError(at_line(file_, at), "names " + std::to_string(table_.names.size()) +
                                              " markers, expected 1 to 2000");
    if (std::isfinite(announced_markers_) &&
        announced_markers_ != static_cast<double>(table_.names.size()))
      table_.remarks.push_back(
          {"markers announced", "the header announces " + format_number(announced_markers_) +
                                    " markers, but " + std::to_string(table_.names.size()) +
                                    " have names"});
    const std::vector<std::string_view> axes = text_cells(line("the axes' names"), '\t');
    const auto named =
        std::find_if(axes.begin(), axes.end(), [](std::string_view cell) { return !cell.empty(); });
    if (named == axes.end() || lower(std::string(*named)).substr(0, 1) != "x")
      throw DataError(at_line(file_, lines_.number()),
                      "is not the line of axes, expected X1, Y1, Z1, X2, ...");
  }

  void read_frames() {
    const std::size_t width = 3 * table_.names.size();
    std::vector<double> values, times;
    int decimals = 0;
    std::string_view row;
    while (lines_.next(row)) {
      if (row.find_first_not_of(" \t") == std::string_view::npos) continue;
      std::vector<std::string_view> cells = text_cells(row, '\t');
      // Empty cells at the end may be missing, a tab at the end be one too many.
      while (cells.size() > width + 2 && cells.back().empty()) cells.pop_back();
      if (cells.size() < 2 || cells.size() > width + 2)
        throw DataError(at_line(file_, lines_.number()),
                        "has " + std::to_string(cells.size()) + " cells, expected " +
                            std::to_string(width + 2) + ": frame, time and three a marker");
      cells.resize(width + 2);
      if (cells[0].empty() && cells[1].empty()) continue;
      times.push_back(cell_number(cells[1], file_, lines_.number()));
      decimals = std::max(decimals, cell_decimals(cells[1]));
      for (std::size_t i = 2; i < cells.size(); ++i)
        values.push_back(cell_number(cells[i], file_, lines_.number()));
      if (times.size() > kMaxClipFrames)
        throw DataError(at_line(file_, lines_.number()),
                        "has more than " + std::to_string(kMaxClipFrames) + " frames");
    }
    if (times.empty()) throw DataError(in_file(file_), "has no frames");
    if (std::isfinite(announced_frames_) && announced_frames_ != static_cast<double>(times.size()))
      table_.remarks.push_back(
          {"frames announced", "the header announces " + format_number(announced_frames_) +
                                   " frames, but " + std::to_string(times.size()) +
                                   " are there, and are read"});
    table_.places = Eigen::Map<const decltype(table_.places)>(
        values.data(), static_cast<Eigen::Index>(times.size()), static_cast<Eigen::Index>(width));
    set_rate(times, decimals);
  }

  void set_rate(const std::vector<double>& times, int decimals) {
    std::vector<Remark> uneven;
    const std::optional<double> told = rate_of_times(times, decimals, file_, uneven);
    const bool has_rate = std::isfinite(rate_) && rate_ > 0;
    if (!told) {
      if (has_rate) table_.fps = rate_;
      return;
    }
    // Times of three digits after the point say less than the header, unless they contradict it.
    const double span = times.back() - times.front();
    const double half_digit = std::pow(10.0, -std::min(decimals, 12));
    const double announced = static_cast<double>(times.size() - 1) / rate_;
    if (has_rate && std::abs(announced - span) <= 2 * half_digit + 0.001 * span) {
      table_.fps = rate_;
      return;
    }
    table_.fps = told;
    table_.remarks.insert(table_.remarks.end(), uneven.begin(), uneven.end());
    if (has_rate)
      table_.remarks.push_back({"frame rate", "the header says " + format_number(rate_) +
                                                  " frames per second, the times " +
                                                  format_number(*told) + ", which are taken"});
  }

  TextLines lines_;
  const std::string& file_;
  PositionTable table_;
  double rate_ = std::nan(""), announced_frames_ = std::nan(""), announced_markers_ = std::nan("");
};

}  // namespace

PositionTable read_trc(const std::string& text, const std::string& file) {
  return TrcReader(text, file).read();
}

}  // namespace mocaplm
