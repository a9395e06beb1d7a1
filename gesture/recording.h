// Movements as they were recorded: CSV files, or anything else that fills these structs.
//
// Columns of a CSV file:
//   time        seconds, rising within a trajectory
//   trajectory  (optional) names the trajectory that the row belongs to; its rows stand together.
//               Without it the file is one trajectory
//   phase       (optional) cuts the trajectory where its value changes
//   event       (optional) what happened at this moment ("catch"); mostly empty
//   others      coordinates, and conditions that a movement may depend on
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace mocaplm {

struct Recording {
  std::string name;
  Eigen::VectorXd time;             // (n) seconds, strictly rising, n >= 2
  Eigen::MatrixXd values;           // (n, coordinates)
  Eigen::MatrixXd more;             // (n, conditions that are columns)
  std::vector<std::string> events;  // (n), or empty
  std::vector<std::string> phases;  // (n), or empty
};

struct Recordings {
  std::string source;                    // for messages
  std::vector<std::string> coordinates;  // at least one
  std::vector<std::string> more;         // columns that are conditions
  std::vector<Recording> all;            // at least one
};

// Whether a condition is one that this program works out itself: start, end, displacement,
// duration.
bool is_own_condition(const std::string& name);

// Reads the files one after the other. `coordinates` may be empty (all columns that are neither
// named above nor in `conditions`). Throws DataError naming file, line and column: a column that is
// missing, cells that are no finite numbers, times that do not rise, a trajectory of fewer than two
// samples or whose rows are torn apart, a name twice.
Recordings read_recordings(const std::vector<std::filesystem::path>& files,
                           const std::vector<std::string>& coordinates,
                           const std::vector<std::string>& conditions);

// The CSV text, read by read_recordings.
std::string recordings_csv(const Recordings& recordings);

// One movement of one phase, cut out of a recording.
struct Demonstration {
  std::string name;        // of the recording, with a number where it holds several
  Eigen::VectorXd time;    // (n) from 0, n >= 4
  Eigen::MatrixXd values;  // (n, V)
  Eigen::VectorXd more;    // (columns that are conditions): at its beginning

  double duration() const { return time(time.size() - 1); }
  Eigen::VectorXd start() const { return values.row(0).transpose(); }
  Eigen::VectorXd end() const { return values.row(values.rows() - 1).transpose(); }
};

}  // namespace mocaplm
