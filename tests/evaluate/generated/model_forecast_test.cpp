// A model's forecast told at another rate than its own.
#include <gtest/gtest.h>

#include "evaluate/generated/forecast.h"
#include "evaluate/generated/small_dancer.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm::model_forecast_test {
namespace {

const int kKnee = joint_index("left_knee"), kElbow = joint_index("right_elbow");

class ModelForecast : public testing::Test {
 protected:
  Generator generator_{small_dancer(), "m"};

  GenerateResult answer(GenerateRequest request) {
    request.sampling.strategy = "greedy";
    return generator_.generate(request);
  }
};

Eigen::Quaterniond rotation(const Clip& clip, Eigen::Index frame, int joint) {
  return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * joint).transpose());
}

TEST_F(ModelForecast, AtTheModelsRateIsWhatItGenerates) {
  const Clip seed = random_clip(3, 40, 20);
  const GenerateRequest request = model_request(seed, 8, generator_);
  EXPECT_EQ(request.prompt->poses, seed.poses);
  const GenerateResult result = answer(request);
  ASSERT_EQ(result.clip.frames(), 48);
  const Clip forecast = model_forecast(seed, 8, result, generator_);
  for (const int joint : {kKnee, kElbow})
    EXPECT_EQ(forecast.poses.middleCols(3 * joint, 3),
              result.clip.poses.bottomRows(8).middleCols(3 * joint, 3));
}

TEST_F(ModelForecast, AtThreeTimesTheRateEveryThirdFrameIsTheModels) {
  const Clip seed = random_clip(4, 120, 60);
  const GenerateRequest request = model_request(seed, 24, generator_);
  // 40 frames of the model's, ending with the last that is shown.
  EXPECT_EQ(request.prompt->poses, seed.poses.bottomRows(118));
  const GenerateResult result = answer(request);
  ASSERT_EQ(result.clip.frames(), 40 + 8);
  EXPECT_EQ(result.context.poses.row(39), seed.poses.row(119));
  const Clip forecast = model_forecast(seed, 24, result, generator_);
  ASSERT_EQ(forecast.frames(), 24);
  for (Eigen::Index t = 0; t < 24; ++t) {
    const Eigen::Index before = 39 + (t + 1) / 3;
    const int part = static_cast<int>((t + 1) % 3);
    for (const int joint : {kKnee, kElbow}) {
      const Eigen::Quaterniond from = rotation(result.clip, before, joint);
      const Eigen::Quaterniond expected =
          part == 0 ? from : from.slerp(part / 3.0, rotation(result.clip, before + 1, joint));
      EXPECT_LT(geodesic_angle(rotation(forecast, t, joint), expected), 1e-7) << t;
    }
  }
}

TEST_F(ModelForecast, JointsThatTheModelLacksStayStill) {
  const Clip seed = random_clip(5, 60, 30);
  const Clip forecast =
      model_forecast(seed, 12, answer(model_request(seed, 12, generator_)), generator_);
  for (int joint = 0; joint < kJoints; ++joint) {
    if (joint == kKnee || joint == kElbow) continue;
    for (Eigen::Index t = 0; t < 12; ++t)
      EXPECT_EQ(forecast.poses.row(t).segment<3>(3 * joint),
                seed.poses.row(59).segment<3>(3 * joint));
  }
}

TEST_F(ModelForecast, HasItsLengthAtAnyRate) {
  for (const double fps : {5.0, 10.0, 12.5, 20.0, 23.976, 24.0, 25.0, 30.0, 59.94, 100.0, 120.0})
    for (const Eigen::Index frames : {1, 2, 7}) {
      const auto shown = static_cast<Eigen::Index>(std::max(2.0, fps));
      const Clip seed = random_clip(6, shown, fps);
      const GenerateResult result = answer(model_request(seed, frames, generator_));
      const Clip forecast = model_forecast(seed, frames, result, generator_);
      EXPECT_EQ(forecast.frames(), frames) << fps;
      EXPECT_NEAR(forecast.fps, fps, 1e-12);
      EXPECT_NO_THROW(check_clip(forecast, "forecast")) << fps;
    }
}

}  // namespace
}  // namespace mocaplm::model_forecast_test
