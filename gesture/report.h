// The statistics of sections III.B and C: does a linear model describe how a movement depends on
// its boundaries?
#pragma once

#include "common/table.h"
#include "gesture/model.h"

namespace mocaplm {

struct ReportConfig {
  std::int64_t simulations = 4000;
  std::int64_t partitions = 100;
  std::int64_t seed = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("simulations", simulations, 100, 1000000,
              "simulations of the normality test's distribution");
    v.integer("partitions", partitions, 0, 10000,
              "random halves of the demonstrations that the F-test is repeated on");
    v.integer("seed", seed, 0, 1000000000, "of simulations and partitions");
  }
};

// Errors of movements, each predicted by a model of all others from its own ends and time, in the
// coordinates' unit.
struct LeftOut {
  double model = 0;          // RMS over samples, coordinates and demonstrations
  double mean_shape = 0;     // of the mean of the others' shapes, put between the ends
  double line = 0;           // of the straight line
  double truncation = 0;     // of the movement's own coefficients: the least that N sines allow
  double inside = 0;         // share of the samples inside the 95% interval
  std::vector<double> each;  // (n): the model's, RMS over samples
};
LeftOut left_out_errors(const PhaseData& data, const GestureConfig& config);

// One row a coefficient of each coordinate: mean size, R^2, R^2 of left out demonstrations, F, p,
// Lilliefors' p, jackknife deviation over size of the largest slope; then a summary of the phase.
// Always of a least squares fit, whatever the model's own regression is.
struct PhaseReport {
  Table coefficients, summary;
};
PhaseReport phase_report(const PhaseModel& model, const PhaseData& data,
                         const GestureConfig& config, const ReportConfig& report);

}  // namespace mocaplm
