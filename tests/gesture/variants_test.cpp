#include "gesture/variants.h"

#include <gtest/gtest.h>

#include "gesture/made_up.h"

namespace mocaplm::variants_test {
namespace {

TEST(Variants, TellWhatTheyAre) {
  const PhaseModel model =
      fit_gesture(made_up_movements(51, 30, 0.1).recordings, made_up_config()).phases[0];
  const Boundary boundary = boundary_between({0, 0}, {2, 1}, 0.5);
  const Eigen::MatrixXd p = model.coefficients(boundary);
  const auto speeds = end_velocity_variants(model, p, {std::nullopt, 0.25}, 0.5);
  const Json first = variant_table(speeds, model, 0.5).json()["rows"];
  ASSERT_EQ(first.size(), 4u);
  EXPECT_EQ(first[0]["change of P"], 0);
  for (const std::size_t i : {1, 2, 3}) EXPECT_NEAR(first[i]["end v_y"].get<double>(), 0.25, 1e-9);
  EXPECT_TRUE(first[1]["jump of speed"].is_null());

  const Eigen::Vector2d state(1.2, 0.3), target(2.2, 0.8);
  const auto ways = correction_variants(model, p, 0.5, state, target);
  const Json rows = variant_table(ways, model, 0.5).json()["rows"];
  EXPECT_EQ(rows[2]["movement"], "smooth");
  EXPECT_NEAR(rows[2]["jump of speed"].get<double>(), 0, 1e-9);
  EXPECT_GT(rows[1]["jump of speed"].get<double>(), 1e-3);
  for (const std::size_t i : {1, 2, 3}) {
    EXPECT_NEAR(rows[i]["end x"].get<double>(), 2.2, 1e-9);
    const Eigen::MatrixXd values = sampled(ways[i], 11);
    EXPECT_LT((values.row(0).transpose() - state).norm(), 1e-9) << "from the state on";
    EXPECT_LT((values.row(10).transpose() - target).norm(), 1e-9);
  }
}

// The peak against second differences of the samples.
TEST(Variants, PeakAccelerationIsThatOfTheSamples) {
  const PhaseModel model =
      fit_gesture(made_up_movements(52, 30, 0.1).recordings, made_up_config()).phases[0];
  const Eigen::MatrixXd p = model.coefficients(boundary_between({0, 0}, {2, 1}, 0.5));
  const std::vector<MovementVariant> one = {{"planned", p, 0}};
  const Eigen::MatrixXd values = sampled(one[0], 1001);
  const double step = 0.5 / 1000;
  double peak = 0;
  for (Eigen::Index i = 1; i < 1000; ++i)
    peak = std::max(
        peak, (values.row(i + 1) - 2 * values.row(i) + values.row(i - 1)).norm() / (step * step));
  const double told =
      variant_table(one, model, 0.5).json()["rows"][0]["peak acceleration"].get<double>();
  EXPECT_NEAR(told / peak, 1, 1e-3);
}

}  // namespace
}  // namespace mocaplm::variants_test
