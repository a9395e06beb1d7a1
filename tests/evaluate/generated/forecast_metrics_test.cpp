#include "evaluate/generated/forecast_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "motion/skeleton.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::forecast_metrics_test {
namespace {

Clip still_clip(Eigen::Index frames) {
  Clip clip;
  clip.fps = 60;
  clip.poses = Poses::Zero(frames, 72);
  clip.trans = Translations::Zero(frames, 3);
  return clip;
}

void turn(Clip& clip, const std::string& joint, const Eigen::Vector3d& by) {
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    clip.poses.row(t).segment<3>(3 * joint_index(joint)) += by.transpose();
}

// The protocol written down plainly with arrays: matrices by Rodrigues' formula, angles by arcsine
// and arccosine, kinematics joint by joint.
struct Slow {
  using Matrix = Eigen::Matrix3d;
  std::vector<Matrix> local = std::vector<Matrix>(24), global = local;
  std::vector<Eigen::Vector3d> position = std::vector<Eigen::Vector3d>(24);

  Slow(const Clip& clip, Eigen::Index frame) {
    const double thigh = (rest_joints().row(4) - rest_joints().row(1)).norm();
    for (int j = 0; j < 24; ++j) {
      const auto i = static_cast<std::size_t>(j);
      bool counts = false;
      for (const int other : {1, 2, 3, 4, 5, 6, 9, 12, 13, 14, 15, 16, 17, 18, 19})
        counts = counts || other == j;
      local[i] = Matrix::Identity();
      const Eigen::Vector3d v = clip.poses.row(frame).segment<3>(3 * j).transpose();
      if (counts && v.norm() > 0) {
        const Eigen::Vector3d n = v / v.norm();
        Matrix cross;
        cross << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
        local[i] += std::sin(v.norm()) * cross + (1 - std::cos(v.norm())) * cross * cross;
      }
      const int parent = joint_parents()[i];
      if (parent < 0) {
        global[i] = local[i];
        position[i].setZero();
        continue;
      }
      const auto p = static_cast<std::size_t>(parent);
      const Eigen::Vector3d bone =
          (rest_joints().row(j) - rest_joints().row(parent)).transpose() / thigh;
      global[i] = global[p] * local[i];
      position[i] = position[p] + global[p] * bone;
    }
  }
  // The angles of the authors' code: of the transposed matrix.
  static Eigen::Vector3d euler(const Matrix& r) {
    const double middle = -std::asin(r(0, 2)), c = std::cos(middle);
    return {std::atan2(r(1, 2) / c, r(2, 2) / c), middle, std::atan2(r(0, 1) / c, r(0, 0) / c)};
  }
};

struct SlowErrors {
  double euler = 0, joint_angle = 0, positional = 0, within[9] = {};
};

SlowErrors slow_errors(const Clip& forecast, const Clip& target, Eigen::Index frame) {
  const Slow a(forecast, frame), b(target, frame);
  const double radii[9] = {.001, .005, .01, .02, .05, .1, .15, .2, .3};
  SlowErrors errors;
  for (const std::size_t j : {1, 2, 3, 4, 5, 6, 9, 12, 13, 14, 15, 16, 17, 18, 19}) {
    errors.euler += (Slow::euler(a.local[j]) - Slow::euler(b.local[j])).squaredNorm();
    const double trace = (a.global[j] * b.global[j].transpose()).trace();
    errors.joint_angle += std::acos(std::min(std::max((trace - 1) / 2, -1.0), 1.0)) / 15;
    const double distance = (a.position[j] - b.position[j]).norm();
    errors.positional += distance / 15;
    for (int r = 0; r < 9; ++r) errors.within[r] += distance <= radii[r] ? 1.0 / 15 : 0;
  }
  errors.euler = std::sqrt(errors.euler);
  return errors;
}

}  // namespace

TEST(ForecastMetrics, AgreeWithAPlainImplementation) {
  const Clip target = random_clip(1, 12), forecast = random_clip(2, 12);
  const ForecastMetrics metrics(forecast_joints(), {target});
  const ForecastErrors errors = metrics.errors(forecast, target);
  for (Eigen::Index t = 0; t < 12; ++t) {
    const SlowErrors slow = slow_errors(forecast, target, t);
    EXPECT_NEAR(errors.euler[t], slow.euler, 1e-9);
    EXPECT_NEAR(errors.joint_angle[t], slow.joint_angle, 1e-6);  // the arccosine is not precise
    EXPECT_NEAR(errors.positional[t], slow.positional, 1e-12);
    for (int r = 0; r < 9; ++r) EXPECT_NEAR(errors.correct(t, r), slow.within[r], 1e-12);
  }
}

TEST(ForecastMetrics, NothingIsWrongWithTheTruth) {
  const Clip clip = random_clip(3, 24);
  const ForecastMetrics metrics(forecast_joints(), {clip});
  const ForecastScore score = score_until(metrics.errors(clip, clip), 24, 400);
  EXPECT_EQ(score.euler, 0);
  EXPECT_NEAR(score.joint_angle, 0, 1e-6);
  EXPECT_EQ(score.positional, 0);
  EXPECT_NEAR(score.auc, 1, 1e-12);
}

TEST(ForecastMetrics, OneTurnedElbow) {
  Clip target = still_clip(4), forecast = still_clip(4);
  target.poses(0, 3 * joint_index("left_elbow") + 1) = 0.5;  // so that this component moves
  turn(forecast, "left_elbow", {0, 0.3, 0});
  const ForecastErrors errors =
      ForecastMetrics(forecast_joints(), {target}).errors(forecast, target);
  EXPECT_NEAR(errors.euler[0], 0.2, 1e-12);
  EXPECT_NEAR(errors.euler[1], 0.3, 1e-12);
  EXPECT_NEAR(errors.joint_angle[1], 0.3 / 15, 1e-12);  // its child, the wrist, does not count
  EXPECT_EQ(errors.positional[1], 0);                   // nor does the wrist's place
  const ForecastScore score = score_until(errors, 3, 50);
  EXPECT_NEAR(score.euler, 0.2 + 2 * 0.3, 1e-12);  // sums, not means
  EXPECT_NEAR(score.joint_angle, 0.8 / 15, 1e-12);
}

TEST(ForecastMetrics, OneTurnedShoulderMovesTheElbow) {
  const Clip target = still_clip(1);
  Clip forecast = still_clip(1);
  turn(forecast, "left_shoulder", {0, 0.4, 0});
  const ForecastErrors errors =
      ForecastMetrics(forecast_joints(), {target}).errors(forecast, target);
  EXPECT_EQ(errors.euler[0], 0);  // the truth never moves: no component counts
  EXPECT_NEAR(errors.joint_angle[0], 2 * 0.4 / 15, 1e-12);
  const Eigen::RowVector3d arm = rest_joints().row(18) - rest_joints().row(16),
                           thigh = rest_joints().row(4) - rest_joints().row(1);
  const double distance =
      2 * std::sin(0.2) * std::hypot(arm.x(), arm.z()) / thigh.norm();  // about the vertical
  EXPECT_NEAR(errors.positional[0], distance / 15, 1e-12);
  for (std::size_t r = 0; r < 9; ++r)
    EXPECT_NEAR(errors.correct(0, static_cast<Eigen::Index>(r)),
                distance <= pck_thresholds()[r] ? 1 : 14.0 / 15, 1e-12);
}

TEST(ForecastMetrics, RootFeetHandsAndTravelDoNotCount) {
  const Clip target = random_clip(4, 3);
  Clip forecast = target;
  for (const char* joint : {"pelvis", "left_ankle", "right_foot", "left_wrist", "right_hand"})
    turn(forecast, joint, {0.5, 0.2, -0.1});
  forecast.trans.array() += 1;
  const ForecastScore score =
      score_until(ForecastMetrics(forecast_joints(), {target}).errors(forecast, target), 3, 400);
  EXPECT_EQ(score.euler, 0);
  EXPECT_NEAR(score.joint_angle, 0, 1e-6);
  EXPECT_EQ(score.positional, 0);
}

// Angles are compared as numbers, not around the circle: the authors' code does.
TEST(ForecastMetrics, EulerAnglesAreNotWrapped) {
  Clip target = still_clip(2), forecast = still_clip(2);
  turn(target, "head", {kPi - 0.1, 0, 0});
  turn(forecast, "head", {-kPi + 0.1, 0, 0});
  target.poses(1, 3 * joint_index("head")) = 0;
  const ForecastErrors errors =
      ForecastMetrics(forecast_joints(), {target}).errors(forecast, target);
  EXPECT_NEAR(errors.euler[0], 2 * kPi - 0.2, 1e-9);
  EXPECT_NEAR(errors.joint_angle[0], 0.2 / 15, 1e-9);
}

TEST(ForecastMetrics, OnlyTheJointsAskedFor) {
  const Clip target = random_clip(5, 2);
  Clip forecast = target;
  turn(forecast, "spine1", {0.3, 0, 0});  // not asked for: unmoved in both
  turn(forecast, "left_knee", {0.3, 0, 0});
  const ForecastMetrics metrics({4, 16}, {target});
  const ForecastErrors errors = metrics.errors(forecast, target);
  const Clip knee = [&] {
    Clip clip = target;
    turn(clip, "left_knee", {0.3, 0, 0});
    return clip;
  }();
  EXPECT_EQ(errors.joint_angle, metrics.errors(knee, target).joint_angle);
  EXPECT_GT(errors.joint_angle[0], 0.01);
}

// Every joint d away: PCK is 0 below d and 1 from there on.
TEST(ForecastMetrics, AreaUnderTheCurveOfPck) {
  ForecastErrors errors;
  errors.euler = errors.joint_angle = errors.positional = Eigen::VectorXd::Zero(2);
  errors.correct = Eigen::MatrixXd::Zero(2, 9);
  errors.correct.rightCols(5).setOnes();  // from 0.05 on
  // Trapezoids: half of (0.02, 0.05), all up to the largest radius that counts.
  EXPECT_NEAR(score_until(errors, 2, 400).auc, (0.015 + 0.25) / 0.299, 1e-12);
  EXPECT_NEAR(score_until(errors, 2, 300).auc, (0.015 + 0.25) / 0.299, 1e-12);
  EXPECT_NEAR(score_until(errors, 2, 200).auc, (0.015 + 0.15) / 0.199, 1e-12);
  EXPECT_NEAR(score_until(errors, 2, 100).auc, (0.015 + 0.10) / 0.149, 1e-12);
  EXPECT_NEAR(score_until(errors, 2, 50).auc, (0.015 + 0.05) / 0.099, 1e-12);
  errors.correct.row(1).setOnes();  // a mean over the frames
  EXPECT_NEAR(score_until(errors, 2, 400).auc, (1 + (0.015 + 0.25) / 0.299) / 2, 1e-12);
  EXPECT_NEAR(score_until(errors, 1, 400).auc, (0.015 + 0.25) / 0.299, 1e-12);
}

}  // namespace mocaplm::forecast_metrics_test
