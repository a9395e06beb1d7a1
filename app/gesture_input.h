// Where the movements of `mocaplm gesture` come from.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "gesture/config.h"
#include "gesture/recording.h"
#include "motion/reading.h"

namespace mocaplm {

struct GestureInput {
  std::vector<std::string> inputs;  // CSV files, or datasets and motion files
  std::string joint = "right_wrist";
  std::string frame = "body";
  std::vector<std::string> where;  // label=value, of a dataset's clips
  MotionReading read_as;           // of motion files

  void add_options(CLI::App& app);
  // CSV files by their columns; clips as the path x, y, z of the joint, each a recording. Throws
  // UsageError for both at once, an unknown joint, labels that no clip has.
  Recordings read(const GestureConfig& config) const;
};

}  // namespace mocaplm
