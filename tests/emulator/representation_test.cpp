#include "emulator/representation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "emulator/helpers.h"

namespace mocaplm::representation_test {

namespace {

const Representation kAll[] = {Representation::siem, Representation::s_tvf, Representation::is_tvf,
                               Representation::m_tvf};

double largest(const PostureSequence& a, const PostureSequence& b) {
  double most = 0;
  for (Eigen::Index t = 0; t < a.frames(); ++t)
    most = std::max(most, posture_distance(a.at(t), b.at(t)));
  return most;
}

TEST(Representation, RoundTripsAreExact) {
  Random random(1);
  for (int k = 0; k < 10; ++k) {
    // Swings over more than half the sphere, and references anywhere.
    const PostureSequence sequence = random_sequence(random, 20, 301, k < 5 ? 0.6 : 3);
    const Posture reference = k % 2 == 0 ? random_posture(random, 20) : Posture(sequence.at(0));
    for (const Representation representation : kAll) {
      const Eigen::MatrixXd flat = flatten(sequence, representation, reference);
      ASSERT_EQ(flat.rows(), 40);
      ASSERT_EQ(flat.cols(), 301);
      EXPECT_LT(largest(unflatten(flat, representation, reference), sequence), 1e-7)
          << to_string(representation);
    }
  }
}

TEST(Representation, SiemThroughOppositePostures) {
  Random random(2);
  const Posture reference = random_posture(random, 3);
  PostureSequence sequence;
  sequence.values.resize(9, 3);
  sequence.at(0) = reference;
  sequence.at(1) = -reference;
  sequence.at(2) = -reference;
  for (const Representation representation : kAll)
    EXPECT_LT(
        largest(unflatten(flatten(sequence, representation, reference), representation, reference),
                sequence),
        1e-10)
        << to_string(representation);
}

// What each one is, by rotations in place of the closed forms.
TEST(Representation, ValuesAreTheDefinitions) {
  Random random(3);
  const PostureSequence path = random_sequence(random, 2, 6);
  const Posture reference = random_posture(random, 2);
  const Eigen::MatrixXd siem = flatten(path, Representation::siem, reference);
  const Eigen::MatrixXd s_tvf = flatten(path, Representation::s_tvf, reference);
  const Eigen::MatrixXd is_tvf = flatten(path, Representation::is_tvf, reference);
  const Eigen::MatrixXd m_tvf = flatten(path, Representation::m_tvf, reference);
  const auto turn = [](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
  };
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Vector3d r = reference.col(i);
    const auto basis = sphere_basis(r);
    Eigen::Vector2d sum = siem.col(0).segment<2>(2 * i);
    for (Eigen::Index t = 0; t < 6; ++t) {
      const Eigen::Vector3d y = path.at(t).col(i);
      const double angle = std::acos(r.dot(y));
      const Eigen::Vector3d log = angle / std::sin(angle) * (y - std::cos(angle) * r);
      EXPECT_LT((basis.transpose() * log - siem.col(t).segment<2>(2 * i)).norm(), 1e-9);
      if (t == 0) continue;
      const Eigen::Vector3d before = path.at(t - 1).col(i);
      const Eigen::Vector3d shot = sphere_log(before, y);
      const Eigen::Vector2d single = basis.transpose() * turn(before, r) * shot;
      EXPECT_LT((single - s_tvf.col(t).segment<2>(2 * i)).norm(), 1e-9);
      sum += single;
      EXPECT_LT((sum - is_tvf.col(t).segment<2>(2 * i)).norm(), 1e-9);
      Eigen::Vector3d hops = shot;
      for (Eigen::Index s = t - 1; s > 0; --s)
        hops = turn(path.at(s).col(i), path.at(s - 1).col(i)) * hops;
      const Eigen::Vector2d many = basis.transpose() * turn(path.at(0).col(i), r) * hops;
      EXPECT_LT((many - m_tvf.col(t).segment<2>(2 * i)).norm(), 1e-9);
      EXPECT_NEAR(single.norm(), shot.norm(), 1e-12);
    }
  }
}

TEST(Representation, NamesAndCoordinates) {
  for (const Representation representation : kAll)
    EXPECT_EQ(parse_representation(to_string(representation)), representation);
  try {
    parse_representation("SEIM");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"SIEM\""), std::string::npos);
  }
  Random random(4);
  const Posture posture = random_posture(random, 4);
  Eigen::VectorXd coordinates(8);
  for (int i = 0; i < 8; ++i) coordinates[i] = random.normal();
  const PostureTangent tangent = tangent_vector(coordinates, posture);
  EXPECT_LT(tangent.cwiseProduct(posture).colwise().sum().norm(), 1e-14);
  EXPECT_NEAR(tangent.norm(), coordinates.norm(), 1e-14);
  EXPECT_LT((tangent_coordinates(tangent, posture) - coordinates).norm(), 1e-14);
}

TEST(Representation, OneFrameIsItsPosture) {
  Random random(5);
  const PostureSequence sequence = random_sequence(random, 3, 1);
  const Posture reference = random_posture(random, 3);
  for (const Representation representation : kAll)
    EXPECT_LT(
        largest(unflatten(flatten(sequence, representation, reference), representation, reference),
                sequence),
        1e-12);
}

}  // namespace

}  // namespace mocaplm::representation_test
