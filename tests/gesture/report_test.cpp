#include "gesture/report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gesture/made_up.h"

namespace mocaplm::report_test {
namespace {

struct Reported {
  PhaseModel model;
  PhaseData data;
  PhaseReport report;
};

Reported report_of(const Recordings& recordings, const GestureConfig& config) {
  const Cut cut = cut_recordings(recordings, config);
  const PhaseData data = phase_data(cut.phases[0], recordings, config);
  const PhaseModel model = fit_phase(cut.phases[0], recordings, config, data);
  ReportConfig settings;
  settings.simulations = 500;
  settings.partitions = 20;
  return {model, data, phase_report(model, data, config, settings)};
}

double cell(const Table& table, std::size_t row, const std::string& column) {
  return table.json()["rows"][row][column].get<double>();
}

// The same by fits that really leave one out.
TEST(LeftOut, IsTheErrorOfAModelOfAllOthers) {
  for (const bool robust : {false, true}) {
    const std::size_t n = robust ? 40 : 16;
    const MadeUp made = made_up_movements(41, static_cast<int>(n), 0.1);
    GestureConfig config = made_up_config();
    config.robust = robust;
    const Cut cut = cut_recordings(made.recordings, config);
    const PhaseData data = phase_data(cut.phases[0], made.recordings, config);
    const LeftOut found = left_out_errors(data, config);
    double square = 0;
    for (std::size_t i = 0; i < n; ++i) {
      PhaseDemonstrations others = cut.phases[0];
      others.all.erase(others.all.begin() + static_cast<std::ptrdiff_t>(i));
      const PhaseModel model =
          fit_phase(others, made.recordings, config, phase_data(others, made.recordings, config));
      Eigen::MatrixXd values(120, 2);
      MovementWriter(model, 120).write(data.boundaries[i], values);
      const double error = std::sqrt((values - data.movements[i]).array().square().mean());
      if (!robust) {
        EXPECT_NEAR(found.each[i], error, 1e-9) << i;
      }
      square += error * error / static_cast<double>(n);
    }
    // A robust fit without a row begins where the fit of all ended, so it may end elsewhere.
    EXPECT_NEAR(found.model, std::sqrt(square), robust ? 0.1 * found.model : 1e-9);
  }
}

TEST(Report, SaysWhatDependsOnTheConditions) {
  const Reported found = report_of(made_up_movements(42, 50, 0.02).recordings, made_up_config());
  const Table& table = found.report.coefficients;
  ASSERT_EQ(table.rows().size(), 8u);
  int normal = 0;
  for (std::size_t row = 0; row < 8; ++row) {
    EXPECT_LT(cell(table, row, "p"), 1e-6);
    EXPECT_GT(cell(table, row, "R2"), 0.9);
    EXPECT_LT(cell(table, row, "R2 left out"), cell(table, row, "R2"));
    EXPECT_EQ(cell(table, row, "halves p < 0.05"), 1);
    EXPECT_LT(cell(table, row, "jackknife"), 0.1);
    normal += cell(table, row, "normal p") >= 0.05;
  }
  EXPECT_GE(normal, 6);
  const LeftOut errors = left_out_errors(found.data, made_up_config());
  EXPECT_LT(errors.model, 0.2 * errors.mean_shape);
  EXPECT_LT(errors.mean_shape, errors.line);
  EXPECT_LT(errors.truncation, 1e-9);
  EXPECT_NEAR(errors.inside, 0.95, 0.03);
}

TEST(Report, FindsNothingWhereNothingIs) {
  MadeUp made = made_up_movements(43, 50, 0.1);
  Random random(44);
  const Eigen::MatrixXd table = Basis(4).table(120);
  for (Recording& one : made.recordings.all)  // shapes that know nothing of the ends
    for (Eigen::Index v = 0; v < 2; ++v) {
      Eigen::VectorXd p(6);
      p << one.values(0, v), one.values(119, v) - one.values(0, v), 0.5, 0.2, 0.1, 0.1;
      for (Eigen::Index k = 2; k < 6; ++k) p(k) += 0.1 * std::exp(random.normal());
      one.values.col(v) = table * p;
    }
  const Reported found = report_of(made.recordings, made_up_config());
  int dependent = 0, normal = 0;
  for (std::size_t row = 0; row < 8; ++row) {
    dependent += cell(found.report.coefficients, row, "p") < 0.05;
    normal += cell(found.report.coefficients, row, "normal p") >= 0.05;
  }
  EXPECT_LE(dependent, 2);
  EXPECT_LE(normal, 3) << "log-normal noise";
  const LeftOut errors = left_out_errors(found.data, made_up_config());
  EXPECT_GT(errors.model, 0.98 * errors.mean_shape) << "nothing is won";
}

TEST(Report, RepeatsWithItsSeed) {
  const MadeUp made = made_up_movements(45, 20, 0.1);
  EXPECT_EQ(report_of(made.recordings, made_up_config()).report.coefficients.text(),
            report_of(made.recordings, made_up_config()).report.coefficients.text());
}

TEST(Report, FewDemonstrationsHaveNoHalves) {
  const Reported found = report_of(made_up_movements(46, 9, 0.1).recordings, made_up_config());
  EXPECT_TRUE(found.report.coefficients.json()["rows"][0]["halves p < 0.05"].is_null());
}

}  // namespace
}  // namespace mocaplm::report_test
