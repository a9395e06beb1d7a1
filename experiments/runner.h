// Trains the rows of an experiment one after the other and tests each on clips it has not seen.
// What is finished is not done again, and a training that was cut off goes on.
#pragma once

#include <filesystem>
#include <vector>

#include "common/table.h"
#include "experiments/experiment.h"

namespace mocaplm {

struct ExperimentOptions {
  std::filesystem::path data, other_data, out;
  std::string split = "test";
  std::string device = "auto";
  int threads = 0;
};

// Fills OUT/ROW/ for every row: request.json (what was asked), run/ (the training run), classifier/
// (for classification), result.json; and OUT/table.json. Returns the tables. Throws UsageError,
// before any work, when the experiment needs a second dataset and none is given, or a row in OUT
// was asked for with other settings; errors of training and testing pass.
std::vector<Table> run_experiment(const Experiment& experiment, const ExperimentOptions& options);

// The name of a row's folder: its letters and digits, and where these do not tell rows apart a
// hash.
std::string row_folder(const std::string& name);

}  // namespace mocaplm
