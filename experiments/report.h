// The tables of an experiment: in the thesis's form, and all that is known of each row.
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "experiments/result.h"

namespace mocaplm {

// Joints whose rotations every row tells; bits are compared over their channels alone.
std::vector<int> shared_joints(const std::vector<RowResult>& rows);

// Mean bits of a frame over the rotations of some joints, all of which the row must have.
double bits_over(const RowResult& row, const std::vector<double>& bits,
                 const std::vector<int>& joints);

// Mean cross-entropy in nats of a token that is predicted (thesis equation 4.4).
double mean_loss(const RowResult& row);

// A line a "row", its bits/frame and loss for each "column" (Tables 4.4 to 4.6), or methods and
// accuracies (Table 4.8); then, for the former, one line a row of the experiment with everything
// else. `split` is what was tested on.
std::vector<Table> experiment_tables(const std::string& title, const std::vector<RowResult>& rows,
                                     const std::string& split);

}  // namespace mocaplm
