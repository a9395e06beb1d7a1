#include "evaluate/generated/forecast_metrics.h"

#include <array>
#include <cassert>
#include <cmath>

#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr double kStill = 1e-4;  // radians
constexpr int kHip = 1, kKnee = 4;

// The authors take the transposed matrix's angles apart: the same three angles with the sign
// changed, so that differences are the same. They are not wrapped.
Eigen::Vector3d euler_angles(const Clip& clip, Eigen::Index frame, int joint) {
  const Eigen::Vector3d v = clip.poses.row(frame).segment<3>(3 * joint).transpose();
  return euler_from_matrix(matrix_from_axis_angle(v), {0, 1, 2});
}

// The frame with these joints alone.
Clip bare_pose(const Clip& clip, Eigen::Index frame, const std::vector<int>& joints) {
  Clip pose;
  pose.poses = Poses::Zero(1, 72);
  pose.trans = Translations::Zero(1, 3);
  for (const int j : joints)
    pose.poses.row(0).segment<3>(3 * j) = clip.poses.row(frame).segment<3>(3 * j);
  return pose;
}

double thigh() {
  return (rest_joints().row(kKnee) - rest_joints().row(kHip)).norm();
}

std::size_t radii_at(double milliseconds) {
  const double tolerance = 1e-6;
  std::size_t radii = 6;
  for (const double from : {100.0, 200.0, 300.0}) radii += milliseconds > from - tolerance ? 1 : 0;
  return radii;
}

}  // namespace

const std::vector<double>& forecast_horizons() {
  static const std::vector<double> horizons = {100, 200, 300, 400};
  return horizons;
}

const std::vector<int>& forecast_joints() {
  static const std::vector<int> joints = {1, 2, 3, 4, 5, 6, 9, 12, 13, 14, 15, 16, 17, 18, 19};
  return joints;
}

const std::vector<double>& pck_thresholds() {
  static const std::vector<double> thresholds = {.001, .005, .01, .02, .05, .1, .15, .2, .3};
  return thresholds;
}

ForecastMetrics::ForecastMetrics(std::vector<int> joints, const std::vector<Clip>& targets)
    : joints_(std::move(joints)), moves_(3 * joints_.size(), false) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    // Differences from the first value, so that a small deviation is not lost in a large mean.
    Eigen::Array3d first = Eigen::Array3d::Zero(), sum = first, squares = first;
    double count = 0;
    for (const Clip& clip : targets)
      for (Eigen::Index t = 0; t < clip.frames(); ++t, ++count) {
        const Eigen::Array3d angles = euler_angles(clip, t, joints_[j]).array();
        if (count == 0) first = angles;
        sum += angles - first;
        squares += (angles - first).square();
      }
    if (count == 0) continue;
    const Eigen::Array3d variance = squares / count - (sum / count).square();
    for (int axis = 0; axis < 3; ++axis)
      moves_[3 * j + static_cast<std::size_t>(axis)] = variance[axis] > kStill * kStill;
  }
}

ForecastErrors ForecastMetrics::errors(const Clip& forecast, const Clip& target) const {
  assert(forecast.frames() == target.frames());
  const Eigen::Index frames = target.frames();
  const auto radii = static_cast<Eigen::Index>(pck_thresholds().size());
  const auto count = static_cast<double>(joints_.size());
  ForecastErrors errors;
  for (Eigen::VectorXd* values : {&errors.euler, &errors.joint_angle, &errors.positional})
    *values = Eigen::VectorXd::Zero(frames);
  errors.correct = Eigen::MatrixXd::Zero(frames, radii);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const std::array<Clip, 2> poses = {bare_pose(forecast, t, joints_),
                                       bare_pose(target, t, joints_)};
    const auto world = joint_world_rotations(poses[0], 0),
               true_world = joint_world_rotations(poses[1], 0);
    const JointPositions apart =
        (joint_positions(poses[0], 0) - joint_positions(poses[1], 0)) / thigh();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const auto joint = static_cast<std::size_t>(joints_[j]);
      const Eigen::Vector3d euler =
          euler_angles(poses[0], 0, joints_[j]) - euler_angles(poses[1], 0, joints_[j]);
      for (int axis = 0; axis < 3; ++axis)
        if (moves_[3 * j + static_cast<std::size_t>(axis)])
          errors.euler[t] += euler[axis] * euler[axis];
      errors.joint_angle[t] += geodesic_angle(quaternion_from_matrix(world[joint]),
                                              quaternion_from_matrix(true_world[joint])) /
                               count;
      const double distance = apart.row(joints_[j]).norm();
      errors.positional[t] += distance / count;
      for (Eigen::Index r = 0; r < radii; ++r)
        if (distance <= pck_thresholds()[static_cast<std::size_t>(r)])
          errors.correct(t, r) += 1 / count;
    }
    errors.euler[t] = std::sqrt(errors.euler[t]);
  }
  return errors;
}

ForecastScore score_until(const ForecastErrors& errors, Eigen::Index frames, double milliseconds) {
  assert(frames > 0 && frames <= errors.euler.size());
  ForecastScore score;
  score.euler = errors.euler.head(frames).sum();
  score.joint_angle = errors.joint_angle.head(frames).sum();
  score.positional = errors.positional.head(frames).sum();
  const Eigen::RowVectorXd pck = errors.correct.topRows(frames).colwise().mean();
  const std::vector<double>& radius = pck_thresholds();
  const std::size_t last = radii_at(milliseconds) - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    score.auc += (pck[r] + pck[r + 1]) / 2 * (radius[i + 1] - radius[i]);
  }
  score.auc /= radius[last] - radius[0];
  return score;
}

}  // namespace mocaplm
