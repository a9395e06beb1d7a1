#include "gesture/phase_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "gesture/made_up.h"
#include "support/refusal.h"

namespace mocaplm::phase_model_test {
namespace {

struct Fit {
  PhaseModel model;
  PhaseData data;
};

Fit fit(const Recordings& recordings, const GestureConfig& config) {
  const Cut cut = cut_recordings(recordings, config);
  PhaseData data = phase_data(cut.phases[0], recordings, config);
  return {fit_phase(cut.phases[0], recordings, config, data), data};
}

TEST(PhaseModel, FindsTheHyperplaneThatMadeTheMovements) {
  const MadeUp made = made_up_movements(1, 30, 0);
  const Fit found = fit(made.recordings, made_up_config());
  EXPECT_LT((found.model.f - made.f).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(found.model.truncation.maxCoeff(), 1e-8);
  EXPECT_EQ(found.model.dof, 25);
}

// Equations 7 and 8 as plain loops.
TEST(PhaseModel, GeneratesByTheEquations) {
  const MadeUp made = made_up_movements(2, 30, 0.1);
  const PhaseModel model = fit(made.recordings, made_up_config()).model;
  const Boundary boundary = boundary_between({0.3, -1}, {2.5, 0.4}, 0.8);
  const double q[5] = {0.3, -1, 2.5, 0.4, 1};
  Eigen::MatrixXd values(200, 2);
  MovementWriter(model, 200).write(boundary, values);
  const Eigen::MatrixXd p = model.coefficients(boundary);
  for (Eigen::Index v = 0; v < 2; ++v) {
    for (Eigen::Index t = 0; t < 200; t += 7) {
      const double tau = static_cast<double>(t) / 199;
      double y = q[v] + (q[v + 2] - q[v]) * tau;
      for (int k = 1; k <= 4; ++k) {
        double coefficient = 0;
        for (int j = 0; j < 5; ++j) coefficient += model.f(v * 6 + k + 1, j) * q[j];
        EXPECT_NEAR(p(k + 1, v), coefficient, 1e-12);
        y += coefficient * std::sin(k * kPi * tau);
      }
      EXPECT_NEAR(values(t, v), y, 1e-12);
    }
    EXPECT_EQ(values(0, v), boundary.start(v));
    EXPECT_NEAR(values(199, v), (*boundary.end)(v), 1e-12);
  }
}

TEST(PhaseModel, ConditionsAreWhatTheirNamesSay) {
  MadeUp made = made_up_movements(3, 30, 0.1);
  made.recordings.more = {"ball"};
  Random random(4);
  for (Recording& one : made.recordings.all)
    one.more = Eigen::MatrixXd::Constant(one.time.size(), 1, random.normal());
  GestureConfig config = made_up_config();
  config.conditions = {"ball", "displacement", "duration", "start"};
  const Fit found = fit(made.recordings, config);
  EXPECT_EQ(found.model.q_names(),
            (std::vector<std::string>{"ball", "displacement_x", "displacement_y", "duration",
                                      "start_x", "start_y"}));
  EXPECT_EQ(found.model.q_is_free(), (std::vector<bool>{true, true, true, false, false, false}));
  Boundary boundary = boundary_between({1, 2}, {5, 9}, 0.7);
  boundary.more = {8};
  Eigen::VectorXd q(6);
  q << 8, 4, 7, 0.7, 1, 2;
  EXPECT_LT((found.model.q(boundary) - q).norm(), 1e-15);
  EXPECT_EQ(found.data.q.row(3)(0), made.recordings.all[3].more(0, 0));
  EXPECT_EQ(found.data.q.row(3)(3), made.recordings.all[3].time(119));
}

TEST(PhaseModel, ADisplacementAloneKnowsNoPlace) {
  const MadeUp made = made_up_movements(5, 40, 0.05);
  GestureConfig config = made_up_config();
  config.conditions = {"displacement"};
  const PhaseModel model = fit(made.recordings, config).model;
  const Eigen::MatrixXd here = model.coefficients(boundary_between({0, 0}, {2, 1}, 1));
  const Eigen::MatrixXd there = model.coefficients(boundary_between({5, 5}, {7, 6}, 1));
  EXPECT_LT((here.bottomRows(5) - there.bottomRows(5)).cwiseAbs().maxCoeff(), 1e-12);
}

// 95 of 100 further movements lie inside, at every time.
TEST(PhaseModel, TheIntervalHoldsWhatItPromises) {
  const MadeUp few = made_up_movements(6, 25, 0.2);
  const MadeUp truth = made_up_movements(6, 2000, 0.2);  // begins with the same ones
  const Fit found = fit(few.recordings, made_up_config());
  const Cut cut = cut_recordings(truth.recordings, made_up_config());
  const PhaseData data = phase_data(cut.phases[0], truth.recordings, made_up_config());
  const std::vector<Eigen::Index> places = {20, 60, 100};
  std::vector<int> inside(places.size());
  int all = 0;
  for (std::size_t i = 25; i < data.movements.size(); ++i, ++all) {
    Eigen::MatrixXd values(120, 2);
    MovementWriter(found.model, 120).write(data.boundaries[i], values);
    const Eigen::MatrixXd half = found.model.interval(data.boundaries[i], 120);
    for (std::size_t j = 0; j < places.size(); ++j)
      inside[j] +=
          std::abs(values(places[j], 0) - data.movements[i](places[j], 0)) <= half(places[j], 0);
  }
  // Of one set of 25: the share varies about 0.95 by some 0.03.
  for (const int count : inside) EXPECT_NEAR(count / double(all), 0.95, 0.07);
}

TEST(PhaseModel, OutliersDoNotMoveARobustModel) {
  MadeUp made = made_up_movements(7, 50, 0.02);
  for (std::size_t i = 0; i < 50; i += 6) {
    Eigen::MatrixXd& values = made.recordings.all[i].values;  // the tracker slipped
    values.middleRows(30, 40).array() += 3;
  }
  GestureConfig config = made_up_config();
  const double plain = (fit(made.recordings, config).model.f - made.f).cwiseAbs().maxCoeff();
  config.robust = true;
  const double robust = (fit(made.recordings, config).model.f - made.f).cwiseAbs().maxCoeff();
  EXPECT_LT(robust, 0.05);
  EXPECT_GT(plain, 4 * robust);
}

TEST(PhaseModel, RefusesWhatCannotBeLearnt) {
  const MadeUp made = made_up_movements(8, 6, 0.1);
  EXPECT_PRED2(contains, refusal([&] { fit(made.recordings, made_up_config()); }),
               "6 demonstrations, but 4 conditions");
  EXPECT_NO_THROW(fit(made_up_movements(8, 7, 0.1).recordings, made_up_config()));

  MadeUp still = made_up_movements(9, 20, 0.1);
  for (Recording& one : still.recordings.all) one.values.col(1).setConstant(0.7);
  EXPECT_PRED2(contains, refusal([&] { fit(still.recordings, made_up_config()); }),
               "coordinate \"y\" is 0.7 in every sample");

  GestureConfig config = made_up_config();
  config.harmonics = 150;
  EXPECT_PRED2(contains,
               refusal<UsageError>([&] { fit(made_up_movements(8, 9, 0.1).recordings, config); }),
               "need at least 152 samples");
  config = made_up_config();
  config.conditions = {"end", "end"};
  EXPECT_THROW(fit(made_up_movements(8, 9, 0.1).recordings, config), UsageError);

  const PhaseModel model = fit(made_up_movements(8, 9, 0.1).recordings, made_up_config()).model;
  Boundary boundary = boundary_between({0, 0}, {1, 1}, 1);
  boundary.end.reset();
  EXPECT_THROW(model.coefficients(boundary), UsageError);
  boundary = boundary_between({0, 0}, {1, 1}, 0);
  EXPECT_THROW(model.coefficients(boundary), UsageError);
  boundary = boundary_between({0, 0}, {1, 1}, 1);
  boundary.more = {3};
  EXPECT_THROW(model.coefficients(boundary), UsageError);
}

}  // namespace
}  // namespace mocaplm::phase_model_test
