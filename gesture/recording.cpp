#include "gesture/recording.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "common/csv.h"
#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

const std::vector<std::string>& named_columns() {
  static const std::vector<std::string> names = {"time", "trajectory", "phase", "event"};
  return names;
}

bool contains(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

// One file's rows, with the columns that matter.
class FileReader {
 public:
  FileReader(const Csv& csv, const Recordings& into) : csv_(csv) {
    time_ = csv.column("time");
    for (const std::string& name : into.coordinates) coordinates_.push_back(csv.column(name));
    for (const std::string& name : into.more) more_.push_back(csv.column(name));
    if (csv.rows.empty()) throw DataError(in_file(csv.file), "has a header line and no rows");
  }

  void read(const std::string& stem, std::vector<Recording>& all) const {
    const int trajectory = csv_.find("trajectory");
    std::set<std::string> seen;
    for (std::size_t from = 0, to; from < csv_.rows.size(); from = to) {
      to = trajectory < 0 ? csv_.rows.size() : from + 1;
      const std::string id = trajectory < 0 ? "" : cell(from, trajectory);
      while (to < csv_.rows.size() && cell(to, trajectory) == id) ++to;
      if (!seen.insert(id).second)
        throw DataError(at_line(csv_.file, csv_.lines[from]),
                        "trajectory \"" + id +
                            "\" goes on here, after another one: its rows must "
                            "stand together");
      all.push_back(rows(from, to, trajectory < 0 ? stem : id));
    }
  }

 private:
  const std::string& cell(std::size_t row, int column) const {
    return csv_.rows[row][static_cast<std::size_t>(column)];
  }

  double number(std::size_t row, std::size_t column) const {
    std::string text = csv_.rows[row][column];
    text.erase(0, text.find_first_not_of(" \t"));
    text.erase(text.find_last_not_of(" \t") + 1);
    double value = 0;
    const char* end = text.data() + text.size();
    const char* begin = text.data() + (text.size() > 1 && text[0] == '+' ? 1 : 0);
    const auto result = std::from_chars(begin, end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value) ||
        std::abs(value) > 1e12)
      throw DataError(at_line(csv_.file, csv_.lines[row]),
                      "column \"" + csv_.columns[column] +
                          "\": expected a finite number, found \"" + csv_.rows[row][column] + "\"");
    return value;
  }

  Eigen::MatrixXd numbers(std::size_t from, std::size_t to,
                          const std::vector<std::size_t>& columns) const {
    Eigen::MatrixXd all(to - from, columns.size());
    for (std::size_t i = from; i < to; ++i)
      for (std::size_t j = 0; j < columns.size(); ++j)
        all(static_cast<Eigen::Index>(i - from), static_cast<Eigen::Index>(j)) =
            number(i, columns[j]);
    return all;
  }

  std::vector<std::string> texts(std::size_t from, std::size_t to, const char* column) const {
    std::vector<std::string> all;
    const int index = csv_.find(column);
    if (index < 0) return all;
    for (std::size_t i = from; i < to; ++i) all.push_back(cell(i, index));
    return all;
  }

  Recording rows(std::size_t from, std::size_t to, const std::string& name) const {
    if (to - from < 2)
      throw DataError(at_line(csv_.file, csv_.lines[from]),
                      "trajectory \"" + name + "\" has one sample, a movement has several");
    Recording recording;
    recording.name = name;
    recording.time = numbers(from, to, {time_}).col(0);
    for (Eigen::Index i = 1; i < recording.time.size(); ++i)
      if (recording.time(i) <= recording.time(i - 1))
        throw DataError(at_line(csv_.file, csv_.lines[from + static_cast<std::size_t>(i)]),
                        "time " + format_number(recording.time(i)) + " s of trajectory \"" + name +
                            "\" is not after that of the sample before, " +
                            format_number(recording.time(i - 1)) + " s");
    recording.values = numbers(from, to, coordinates_);
    recording.more = numbers(from, to, more_);
    recording.events = texts(from, to, "event");
    recording.phases = texts(from, to, "phase");
    return recording;
  }

  const Csv& csv_;
  std::size_t time_ = 0;
  std::vector<std::size_t> coordinates_, more_;
};

}  // namespace

bool is_own_condition(const std::string& name) {
  static const std::vector<std::string> own = {"start", "end", "displacement", "duration"};
  return contains(own, name);
}

Recordings read_recordings(const std::vector<std::filesystem::path>& files,
                           const std::vector<std::string>& coordinates,
                           const std::vector<std::string>& conditions) {
  if (files.empty()) throw UsageError("no file of trajectories is given");
  Recordings into;
  into.coordinates = coordinates;
  for (const std::string& name : conditions)
    if (!is_own_condition(name)) into.more.push_back(name);
  std::vector<std::string> names;
  for (const auto& file : files) names.push_back(file.string());
  into.source = join(names, ", ");
  std::set<std::string> seen;
  for (const auto& file : files) {
    const Csv csv = read_csv(file);
    if (into.coordinates.empty()) {
      for (const std::string& column : csv.columns)
        if (!contains(named_columns(), column) && !contains(into.more, column))
          into.coordinates.push_back(column);
      if (into.coordinates.empty())
        throw DataError(
            at_line(csv.file, 1),
            "has no column that could be a coordinate (columns: " + join(csv.columns, ", ") + ")");
    }
    std::vector<Recording> found;
    FileReader(csv, into).read(file.stem().string(), found);
    for (Recording& recording : found) {
      if (files.size() > 1) recording.name = file.stem().string() + " " + recording.name;
      if (!seen.insert(recording.name).second)
        throw DataError(in_file(csv.file), "a trajectory \"" + recording.name +
                                               "\" was already read from another file");
      into.all.push_back(std::move(recording));
    }
  }
  return into;
}

std::string recordings_csv(const Recordings& recordings) {
  const auto shortest = [](double value) {
    char buffer[64];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  };
  std::string text = "trajectory,time," + join(recordings.coordinates, ",");
  for (const std::string& name : recordings.more) text += "," + name;
  text += ",event\n";
  for (const Recording& one : recordings.all)
    for (Eigen::Index i = 0; i < one.time.size(); ++i) {
      text += one.name + "," + shortest(one.time(i));
      for (Eigen::Index j = 0; j < one.values.cols(); ++j) text += "," + shortest(one.values(i, j));
      for (Eigen::Index j = 0; j < one.more.cols(); ++j) text += "," + shortest(one.more(i, j));
      text += "," + (one.events.empty() ? "" : one.events[static_cast<std::size_t>(i)]) + "\n";
    }
  return text;
}

}  // namespace mocaplm
