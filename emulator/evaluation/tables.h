// The evaluation as tables: the paper's Tables 1 to 5, and what they leave out.
#pragma once

#include <vector>

#include "common/table.h"
#include "emulator/evaluation/evaluation.h"

namespace mocaplm {

// Table 1 (components and reconstruction errors), 2 (two-sample tests, beside real against real;
// over several splits medians and how many were rejected), 2 against the clips fitted to, as the
// paper does, 3 (two levels, where simulated), 4 (variability of quantised sequences), 5
// (transitions), and one that tells how simulated motions differ from real ones.
std::vector<Table> evaluation_tables(const Evaluation& evaluation);

}  // namespace mocaplm
