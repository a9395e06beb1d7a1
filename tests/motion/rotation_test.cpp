#include "motion/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "motion/helpers.h"

namespace mocaplm::rotation_test {
namespace {

// Independent reference: the matrix exponential of the cross-product matrix, by its series after
// halving.
Eigen::Matrix3d exponential(const Eigen::Vector3d& v) {
  int halvings = 0;
  for (double size = v.norm(); size > 0.01; size /= 2) ++halvings;
  const Eigen::Vector3d w = v / std::ldexp(1, halvings);
  Eigen::Matrix3d cross;
  cross << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int n = 1; n <= 10; ++n) sum += term = term * cross / n;
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum;
}

// The angles at which conversions tend to break.
const std::vector<double>& hard_angles() {
  static const std::vector<double> angles = {
      0,          1e-300,     1e-160,     1e-20,      1e-12,       1e-9,        1e-8,
      1e-7,       1e-5,       2e-4,       1e-3,       0.5,         kPi / 2,     2,
      kPi - 1e-3, kPi - 1e-5, kPi - 1e-7, kPi - 1e-9, kPi - 1e-12, kPi - 1e-15, kPi};
  return angles;
}

std::vector<Eigen::Vector3d> directions() {
  std::vector<Eigen::Vector3d> all;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) all.push_back(Eigen::Vector3d(x, y, z).normalized());
  Random random(1);
  for (int i = 0; i < 40; ++i) all.push_back(random_direction(random));
  all.push_back(Eigen::Vector3d(1, 1e-9, -1e-9).normalized());
  return all;
}

const std::vector<EulerOrder>& orders() {
  static const std::vector<EulerOrder> all = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                              {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  return all;
}

TEST(Rotation, MatrixIsTheExponential) {
  for (const Eigen::Vector3d& axis : directions())
    for (double angle : hard_angles())
      ASSERT_LT((matrix_from_axis_angle(angle * axis) - exponential(angle * axis)).norm(), 1e-12)
          << angle;
}

TEST(Rotation, AxisAngleComesBackNearZeroAndNearPi) {
  for (const Eigen::Vector3d& axis : directions())
    for (double angle : hard_angles()) {
      const Eigen::Vector3d v = angle * axis;
      const Eigen::Vector3d by_quaternion =
          axis_angle_from_quaternion(quaternion_from_axis_angle(v));
      const Eigen::Vector3d by_matrix = axis_angle_from_matrix(matrix_from_axis_angle(v));
      // Within rounding of pi both signs are the same rotation.
      const bool either = angle > kPi - 1e-14;
      const auto error = [&](const Eigen::Vector3d& back) {
        return either ? std::min((back - v).norm(), (back + v).norm()) : (back - v).norm();
      };
      ASSERT_LE(error(by_quaternion), 1e-15 + 1e-14 * angle) << angle << " " << axis.transpose();
      ASSERT_LE(error(by_matrix), 1e-14) << angle << " " << axis.transpose();
      ASSERT_LE(by_quaternion.norm(), kPi + 1e-15);
      if (angle < 1e-4) {  // tiny rotations keep their relative precision
        ASSERT_LE((by_quaternion - v).norm(), 1e-15 * angle);
      }
    }
}

TEST(Rotation, AxisAngleBeyondPiBecomesTheShortest) {
  for (const Eigen::Vector3d& axis : directions())
    for (double angle : {3.2, 4.0, 6.0, 2 * kPi - 1e-9, 2 * kPi + 1e-9, 9.0, 100.0}) {
      const Eigen::Vector3d back =
          axis_angle_from_quaternion(quaternion_from_axis_angle(angle * axis));
      ASSERT_LT((back - std::remainder(angle, 2 * kPi) * axis).norm(), 1e-13) << angle;
    }
}

TEST(Rotation, RandomRoundTrips) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d v = random.uniform(0, kPi - 1e-6) * random_direction(random);
    const Eigen::Matrix3d matrix = matrix_from_axis_angle(v);
    ASSERT_LT((axis_angle_from_matrix(matrix) - v).norm(), 1e-13);
    ASSERT_LT((matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    ASSERT_NEAR(matrix.determinant(), 1, 1e-14);
    ASSERT_LT((quaternion_from_matrix(matrix).toRotationMatrix() - matrix).norm(), 1e-14);
  }
}

TEST(Rotation, EulerIsTheProductInTheOrderWritten) {
  const Eigen::Vector3d angles(0.3, -0.7, 1.1);
  for (const EulerOrder& order : orders()) {
    Eigen::Matrix3d product = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i)
      product *= exponential(angles[i] * Eigen::Vector3d::Unit(order[static_cast<std::size_t>(i)]));
    EXPECT_LT((matrix_from_euler(angles, order) - product).norm(), 1e-12);
  }
}

TEST(Rotation, EulerComesBackInAllOrders) {
  Random random(3);
  for (const EulerOrder& order : orders())
    for (int i = 0; i < 5000; ++i) {
      const Eigen::Vector3d angles(random.uniform(-kPi, kPi), random.uniform(-1.5, 1.5),
                                   random.uniform(-kPi, kPi));
      const Eigen::Vector3d back = euler_from_matrix(matrix_from_euler(angles, order), order);
      ASSERT_LT((back - angles).norm(), 1e-13) << angles.transpose();
    }
}

// Near and at the gimbal lock the angles are not unique, but they must make the same rotation.
TEST(Rotation, EulerIsExactAtAndNearTheGimbalLock) {
  Random random(4);
  for (const EulerOrder& order : orders())
    for (double away : {0.0, 1e-16, 1e-12, 1e-10, 2e-9, 1e-8, 1e-7, 1e-5, 1e-3})
      for (double sign : {-1.0, 1.0})
        for (int i = 0; i < 50; ++i) {
          const Eigen::Vector3d angles(random.uniform(-kPi, kPi), sign * (kPi / 2 - away),
                                       random.uniform(-kPi, kPi));
          const Eigen::Matrix3d matrix = matrix_from_euler(angles, order);
          const Eigen::Vector3d back = euler_from_matrix(matrix, order);
          // Where the third angle is given up (cosine below 1e-12), that is the error.
          const double error = (matrix_from_euler(back, order) - matrix).norm();
          ASSERT_LT(error, away > 1e-11 ? 1e-14 : 3e-12) << away;
          ASSERT_LE(std::abs(back[1]), kPi / 2);
        }
}

TEST(Rotation, GeodesicAngleIsTheAngleOfTheDifference) {
  for (const Eigen::Vector3d& axis : directions())
    for (double angle : hard_angles()) {
      const Eigen::Quaterniond a = quaternion_from_axis_angle({0.3, -0.2, 0.9});
      const Eigen::Quaterniond b = a * quaternion_from_axis_angle(angle * axis);
      ASSERT_NEAR(geodesic_angle(a, b), angle, 1e-14);
      ASSERT_NEAR(geodesic_angle(a, Eigen::Quaterniond(-b.coeffs())), angle, 1e-14);
    }
}

TEST(Rotation, ShortestRotationTurnsOneDirectionIntoTheOther) {
  for (const Eigen::Vector3d& from : directions())
    for (double angle : hard_angles()) {
      const Eigen::Vector3d side = from.unitOrthogonal();
      const Eigen::Vector3d to = std::cos(angle) * from + std::sin(angle) * side;
      const Eigen::Quaterniond q = shortest_rotation(0.3 * from, 7 * to);
      ASSERT_NEAR(q.norm(), 1, 1e-14) << angle;
      ASSERT_LT((q * from - to).norm(), 1e-14) << angle;
      ASSERT_NEAR(geodesic_angle(Eigen::Quaterniond::Identity(), q), angle, 2e-15) << angle;
    }
}

TEST(ContinuousAxisAngle, IsTheNearestOfTheSameRotationWithinTheLimit) {
  Random random(5);
  for (int i = 0; i < 5000; ++i) {
    const double limit = random.uniform(kPi, 7);
    const Eigen::Vector3d v = random.uniform(0, kPi) * random_direction(random);
    const Eigen::Vector3d previous = random.uniform(0, limit) * random_direction(random);
    const Eigen::Vector3d found = continuous_axis_angle(v, previous, limit);
    ASSERT_LT((matrix_from_axis_angle(found) - matrix_from_axis_angle(v)).norm(), 1e-12);
    ASSERT_LE(found.cwiseAbs().maxCoeff(), limit);
    for (int k = -3; k <= 3; ++k) {
      const Eigen::Vector3d other = v + 2 * kPi * k * v.normalized();
      if (other.cwiseAbs().maxCoeff() <= limit) {
        ASSERT_LE((found - previous).norm(), (other - previous).norm() + 1e-9);
      }
    }
  }
}

TEST(ContinuousAxisAngle, FollowsASpinThroughPi) {
  const Eigen::Vector3d axis = Eigen::Vector3d(2, -1, 2) / 3;
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  for (double angle = 0; angle < 4.6; angle += 0.05) {  // the largest component reaches 3.07
    previous = continuous_axis_angle(std::remainder(angle, 2 * kPi) * axis, previous, kPi);
    ASSERT_LT((previous - angle * axis).norm(), 1e-9) << angle;
  }
}

TEST(ContinuousAxisAngle, KeepsAWholeTurnWhenTheRotationIsNone) {
  const Eigen::Vector3d previous(0, 6.2, 0);
  const Eigen::Vector3d found = continuous_axis_angle(Eigen::Vector3d::Zero(), previous, 7);
  EXPECT_LT((found - Eigen::Vector3d(0, 2 * kPi, 0)).norm(), 1e-12);
  EXPECT_EQ(continuous_axis_angle(Eigen::Vector3d::Zero(), previous, kPi).norm(), 0);
}

}  // namespace
}  // namespace mocaplm::rotation_test
