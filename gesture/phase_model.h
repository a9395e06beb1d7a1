// The model of one phase: a linear map from the conditions Q at its boundaries to the coefficients
// P of the movement (equations 5 to 8 of Lippi, Avizzano and Ruffaldi 2012; basis.h).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "gesture/basis.h"
#include "gesture/config.h"
#include "gesture/segment.h"

namespace mocaplm {

// What is known before a movement begins. V coordinates.
struct Boundary {
  Eigen::VectorXd start;               // (V)
  std::optional<Eigen::VectorXd> end;  // (V)
  double duration = 0;                 // T, seconds
  std::vector<double> more;            // conditions that are columns, in the model's order
};

struct PhaseModel {
  std::string name;
  Rule rule;                             // when it is over
  std::vector<std::string> coordinates;  // V
  std::vector<std::string> conditions;   // as in GestureConfig
  int harmonics = 0;                     // N; M = N + 2
  Eigen::MatrixXd f;                     // (V * M, k + 1): F of each coordinate, one below another
  Eigen::MatrixXd covariance;            // (V * M, M): residual covariance of each coordinate's P
  Eigen::MatrixXd gram_inverse;          // (k + 1, k + 1), see LinearRegression
  Eigen::Index dof = 0, rank = 0;        // of the regression
  Eigen::VectorXd truncation;            // (V): RMS of what the expansion leaves out
  std::vector<Boundary> demonstrations;  // what it was made from, each with its end
  std::vector<std::string> demonstration_names;

  Eigen::Index dimensions() const { return static_cast<Eigen::Index>(coordinates.size()); }
  Eigen::Index size() const { return harmonics + 2; }
  Eigen::Index n_conditions() const { return f.cols() - 1; }
  // (M, k + 1): one coordinate's hyperplane.
  Eigen::MatrixXd plane(Eigen::Index v) const { return f.middleRows(v * size(), size()); }
  double shortest() const;  // seconds, of the demonstrations
  double longest() const;

  // Q (k). Throws UsageError when the end is needed and missing, or sizes do not agree.
  Eigen::VectorXd q(const Boundary& boundary) const;
  // "start_x", "end_y", "duration", ...: what each number of Q is.
  std::vector<std::string> q_names() const;
  // The numbers of Q that the future may change: all but start and duration.
  std::vector<bool> q_is_free() const;

  // Equation 7: P (M, V). The first two are set from the ends (from the regression where the
  // boundary has no end).
  Eigen::MatrixXd coefficients(const Boundary& boundary) const;
  // (samples, V): half the width of the 95% interval of another such movement at tau = 0 ... 1.
  Eigen::MatrixXd interval(const Boundary& boundary, Eigen::Index samples) const;
};

// The numbers that the regression is made of.
struct PhaseData {
  Eigen::MatrixXd q;           // (n, k)
  Eigen::MatrixXd p;           // (n, V * M)
  Eigen::VectorXd truncation;  // (V)
  std::vector<Boundary> boundaries;
  std::vector<Eigen::MatrixXd> movements;  // n of (samples, V): as measured, warped to [0, 1]
};

// Throws DataError: a coordinate that never moves, fewer samples than harmonics ask for;
// UsageError: a condition named twice.
PhaseData phase_data(const PhaseDemonstrations& phase, const Recordings& recordings,
                     const GestureConfig& config);
// Throws DataError when there are fewer demonstrations than unknowns + 2.
PhaseModel fit_phase(const PhaseDemonstrations& phase, const Recordings& recordings,
                     const GestureConfig& config, const PhaseData& data);

// Writes movements quickly: everything that does not depend on the conditions is worked out before.
class MovementWriter {
 public:
  MovementWriter(const PhaseModel& model, Eigen::Index samples);
  // values (samples, V), allocated by the caller; equations 7 and 8.
  void write(const Boundary& boundary, Eigen::MatrixXd& values);

 private:
  const PhaseModel& model_;
  Eigen::MatrixXd table_;  // (samples, M)
  Eigen::VectorXd q_;      // (k + 1)
  Eigen::VectorXd p_;      // (V * M)
};

}  // namespace mocaplm
