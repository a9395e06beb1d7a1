#include "emulator/sphere.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "common/angles.h"
#include "emulator/helpers.h"

namespace mocaplm::sphere_test {

namespace {

TEST(Sphere, DistanceIsTheArcCosine) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d y = random_direction(random), z = random_direction(random);
    EXPECT_NEAR(sphere_distance(y, z), std::acos(y.dot(z)), 1e-7);
  }
  const Eigen::Vector3d x(1, 0, 0);
  EXPECT_EQ(sphere_distance(x, x), 0);
  EXPECT_DOUBLE_EQ(sphere_distance(x, -x), kPi);
  // arccos would say 0 here.
  EXPECT_NEAR(sphere_distance(x, Eigen::Vector3d(1, 1e-10, 0)), 1e-10, 1e-20);
}

TEST(Sphere, ExpIsARotationAboutTheNormal) {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d y = random_direction(random);
    const double angle = random.uniform(1e-9, 3 * kPi);
    const Eigen::Vector3d v = random_tangent(random, y, angle);
    const Eigen::Vector3d turned = Eigen::AngleAxisd(angle, y.cross(v).normalized()) * y;
    EXPECT_LT((sphere_exp(y, v) - turned).norm(), 1e-14);
  }
  const Eigen::Vector3d y = random_direction(random);
  EXPECT_LT((sphere_exp(y, Eigen::Vector3d::Zero()) - y).norm(), 1e-15);
}

TEST(Sphere, LogUndoesExp) {
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    const Eigen::Vector3d y = random_direction(random);
    const Eigen::Vector3d v = random_tangent(random, y, random.uniform(0, kPi - 1e-3));
    EXPECT_LT((sphere_log(y, sphere_exp(y, v)) - v).norm(), 1e-12);
    const Eigen::Vector3d z = random_direction(random);
    EXPECT_LT((sphere_exp(y, sphere_log(y, z)) - z).norm(), 1e-14);
    EXPECT_NEAR(sphere_log(y, z).norm(), sphere_distance(y, z), 1e-14);
    EXPECT_NEAR(sphere_log(y, z).dot(y), 0, 1e-14);
  }
}

TEST(Sphere, TransportIsTheRotationAlongTheGeodesic) {
  Random random(4);
  for (int k = 0; k < 500; ++k) {
    const Eigen::Vector3d y = random_direction(random), z = random_direction(random);
    const Eigen::Vector3d v = random_tangent(random, y, random.uniform(0, 2));
    const Eigen::Vector3d moved = sphere_transport(v, y, z);
    const Eigen::Vector3d turned = Eigen::Quaterniond::FromTwoVectors(y, z) * v;
    EXPECT_LT((moved - turned).norm(), 1e-12);
    EXPECT_NEAR(moved.norm(), v.norm(), 1e-14);
    EXPECT_NEAR(moved.dot(z), 0, 1e-14);
    EXPECT_LT((sphere_transport(moved, z, y) - v).norm(), 1e-14);
    const Eigen::Vector3d w = random_tangent(random, y, 1);
    EXPECT_NEAR(moved.dot(sphere_transport(w, y, z)), v.dot(w), 1e-13);
  }
}

// The transport of the velocity of a geodesic is its velocity at the other end.
TEST(Sphere, TransportKeepsTheVelocityOfTheGeodesic) {
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d y = random_direction(random), z = random_direction(random);
    EXPECT_LT((sphere_transport(sphere_log(y, z), y, z) + sphere_log(z, y)).norm(), 1e-12);
  }
}

TEST(Sphere, CoincidentAndOppositePoints) {
  Random random(6);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d y = random_direction(random);
    const Eigen::Vector3d v = random_tangent(random, y, 1.5);
    EXPECT_EQ(sphere_log(y, y).norm() < 1e-15, true);
    EXPECT_LT((sphere_transport(v, y, y) - v).norm(), 1e-13);
    const Eigen::Vector3d there = sphere_log(y, -y);
    EXPECT_NEAR(there.norm(), kPi, 1e-15);
    EXPECT_NEAR(there.dot(y), 0, 1e-15);
    EXPECT_LT((sphere_exp(y, there) + y).norm(), 1e-15);
    const Eigen::Vector3d moved = sphere_transport(v, y, -y);
    EXPECT_NEAR(moved.norm(), 1.5, 1e-14);
    EXPECT_NEAR(moved.dot(y), 0, 1e-14);
    EXPECT_LT((sphere_transport(moved, -y, y) - v).norm(), 1e-14);
    // The velocity of the chosen geodesic, too.
    EXPECT_LT((sphere_transport(there, y, -y) + sphere_log(-y, y)).norm(), 1e-14);
  }
}

TEST(Sphere, BasisIsOrthonormalAndTangent) {
  Random random(7);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d y = random_direction(random);
    Eigen::Matrix3d frame;
    frame << y, sphere_basis(y);
    EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  }
}

double sum_of_squares(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& y) {
  double sum = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    sum += std::pow(std::acos(std::min(1.0, std::max(-1.0, y.dot(points.col(i))))), 2);
  return sum;
}

TEST(Sphere, MeanIsTheMinimum) {
  Random random(8);
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3d centre = random_direction(random);
    Eigen::Matrix3Xd points(3, 25);
    for (Eigen::Index i = 0; i < 25; ++i)
      points.col(i) = sphere_exp(centre, random_tangent(random, centre, random.uniform(0, 1.4)));
    const Eigen::Vector3d mean = sphere_mean(points);
    const double least = sum_of_squares(points, mean);
    for (const double step : {1e-3, 1e-2, 0.3})
      for (int d = 0; d < 8; ++d)
        EXPECT_GT(sum_of_squares(points, sphere_exp(mean, random_tangent(random, mean, step))),
                  least);
    // A turn of all points turns the mean.
    const Eigen::Matrix3d turn = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
    EXPECT_LT((sphere_mean(turn * points) - turn * mean).norm(), 1e-10);
  }
}

TEST(Sphere, MeanOfTwoIsBetweenAndOfOppositePointsIsOnTheEquator) {
  Eigen::Matrix3Xd points(3, 2);
  points << 1, 0, 0, 1, 0, 0;
  EXPECT_LT((sphere_mean(points) - Eigen::Vector3d(1, 1, 0).normalized()).norm(), 1e-12);
  points.col(1) = -points.col(0);
  const Eigen::Vector3d mean = sphere_mean(points);
  EXPECT_NEAR(mean.norm(), 1, 1e-12);
  EXPECT_NEAR(mean.dot(points.col(0)), 0, 1e-12);
  EXPECT_LT((sphere_mean(points.leftCols(1)) - points.col(0)).norm(), 1e-15);
}

}  // namespace

}  // namespace mocaplm::sphere_test
