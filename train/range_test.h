// The learning-rate range test (Smith, "Cyclical learning rates", 2017; thesis Figure 4.9): the
// rate rises exponentially from step to step while the loss is watched.
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "train/trainer.h"

namespace mocaplm {

struct RangeTestResult {
  std::vector<double> rates, losses;  // one a step, losses in nats; ends early where it diverges
  std::vector<double> smooth;         // losses, averaged over the neighbouring steps
  double steepest = 0;  // rate at which the smoothed loss falls fastest over the rate's logarithm
  double lowest = 0;    // rate at which it is lowest: beyond, it rises
  bool rises = false;   // whether it was seen to rise; otherwise the highest rate was too low
  double proposed = 0;
};

// What the curve says: `smooth` is the mean of the steps at most a twentieth of them away on each
// side; the proposal is the steepest rate, where the curve turns upwards at most a tenth of the
// lowest point's (the thesis's choice). At least 10 steps.
RangeTestResult read_range(const std::vector<double>& rates, const std::vector<double>& losses);

// Trains from fresh weights (or options.from) with AdamW and the run's own settings but for the
// schedule, and keeps no model. Stops early where the loss, averaged over a few steps, is a fifth
// above the first steps' or not finite. Writes OUT/range_test.json. Throws as train does.
RangeTestResult range_test(const TrainOptions& options, const RangeTestConfig& config);

Table range_test_table(const RangeTestResult& result);

}  // namespace mocaplm
